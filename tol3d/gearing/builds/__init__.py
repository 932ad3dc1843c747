"""From deviations to builds: what effects displace, where the gears then lie, and the rates of that."""

"""How a train is shown: its chain, its stages as tables, its parts in one world."""

"""Reports as one HTML file that opens anywhere: tables from pages as they are, charts as SVG, nothing from outside."""

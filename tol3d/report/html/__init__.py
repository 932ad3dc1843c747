"""Reports as one HTML file that opens anywhere: tables from pages, charts as SVG, nothing from outside."""

"""How gears in mesh and their trains are shown: chains, tables of stages, parts in one world, gaps."""

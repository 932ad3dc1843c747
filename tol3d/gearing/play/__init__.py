"""Play of meshes and other links, added up along a train and compared where load paths join, by both methods."""

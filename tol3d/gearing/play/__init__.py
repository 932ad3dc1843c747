"""Play of meshes and other links, added up along a train and compared where load paths join; the same on both roads."""

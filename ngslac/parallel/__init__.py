"""Contact on meshes that NGSolve distributes over processes."""

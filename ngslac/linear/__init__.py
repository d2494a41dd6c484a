"""Linear systems: merged, condensed, factored, iterated, and checked."""

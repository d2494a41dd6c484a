"""What touches: the contact condition of two surfaces, and what is known of it."""

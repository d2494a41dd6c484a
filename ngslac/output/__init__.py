"""How contact is looked at: fields, pictures, files."""

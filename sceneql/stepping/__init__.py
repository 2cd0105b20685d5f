"""What solver words share: tableaus, splittings, radau's stages, and how errors are measured."""

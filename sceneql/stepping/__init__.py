"""What solver words share: tableaus, splittings, radau."""

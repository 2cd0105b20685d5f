"""Pages on scenes: plan, errors, gallery, manual."""

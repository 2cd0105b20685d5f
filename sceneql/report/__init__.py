"""Pages on scenes: plan, errors, studies, gallery."""

"""What is told about scenes: plan, error against run time, gallery, manual. Calls the pipeline, writes pages."""

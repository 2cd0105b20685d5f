"""A graph's run: moments read off the marching islands, what is remembered, measured and watched."""

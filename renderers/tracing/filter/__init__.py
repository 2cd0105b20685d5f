"""Pictures put together of samples: filtered visibility, edges, refinement."""

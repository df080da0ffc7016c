"""Many flights: a process pool that survives a kill, plans of flights, tables of results."""

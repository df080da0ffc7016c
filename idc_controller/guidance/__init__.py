"""Where the payload flies: detours round obstacles on the map, and places to come to rest."""

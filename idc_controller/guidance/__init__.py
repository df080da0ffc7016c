"""Progress along the mission, detours round obstacles on the map, and places to come to rest."""

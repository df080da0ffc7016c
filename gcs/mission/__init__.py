"""Mission files: read, checked and described, from three formats into one :class:`gcs.mission.model.Mission`."""

"""The commands of ``gcs``, a module each: ``DESCRIPTION``, ``add_arguments(parser)``, ``run(arguments)``."""

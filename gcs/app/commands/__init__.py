"""The commands of ``gcs``, a module each: ``DESCRIPTION``, ``add_arguments(parser)``, ``run(arguments)``.

``run`` imports what the command works with, which ``--help`` must not wait for.
"""

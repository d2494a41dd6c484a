"""Demonstration problems: meshes, runs and pictures.

Every demo is a module with a function ``Run``, started from the command line by::

    python -m ngslac.demos.hertz3d --out results
"""

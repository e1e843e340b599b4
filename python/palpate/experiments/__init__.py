"""Experiments that test what palpate promises: random problems whose answer is known, and tables for the docs.

Each is a module to be run: `python -m palpate.experiments.campaign_plane`, `... .no_normals`, `... .tightness`.
"""

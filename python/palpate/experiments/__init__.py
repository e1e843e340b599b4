"""Experiments that test what palpate promises, and make the tables of the docs.

Each is a module to be run, such as `python -m palpate.experiments.campaign_plane`; the Makefile names them.
"""

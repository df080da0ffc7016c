"""Fault injection: disturbs samples, datagrams and the world as a mission's faults say.

The kinds take long to import, spent only where there are faults; a flight without them imports ``disturbances`` alone.
"""

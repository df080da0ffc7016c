"""Missions, campaigns and systems that come with the package, installed as ``gcs.missions``.

The first line of a TOML file says what it is (``gcs missions``); the formats of ground stations have no comments.
"""

DESCRIPTIONS = {
    "delivery": "A QGroundControl plan: waypoints at 1 to 2 m/s, a hold, and a landing away from the pad.",
    "fenced_delivery": "A QGroundControl plan with a fence, of which a pole and a wall are in the way.",
    "three_stops": "A QGroundControl plan: lands at three stops, unloads at two of them, and returns.",
    "short_delivery": "QGC WPL 110: the shortest mission that lands and unloads twice, and returns.",
    "square": "QGC WPL 110: twice around a square of 10 m, and back to the pad.",
}

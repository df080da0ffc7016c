"""Fly a mission with a team that takes orders: pause, go to, resume, and what the flight was like."""

import gcs

with gcs.Team.simulate(seed=1) as team:
    team.upload("missions/square.waypoints")
    team.start()
    while team.position[0] < 3.0:
        team.run(0.5)
    team.pause()
    team.go_to(2.0, 2.0, 4.0)
    team.wait()
    team.resume()
    flight = team.finish()
print(flight.outcome, flight.figures["position_rmse_m"]["total"], len(flight.truth))

"""Fly the same hop with payloads lighter and heavier than the controller assumes, and compare the flights."""

import gcs

for factor in (0.9, 1.0, 1.1):
    flight = gcs.fly("missions/hop.toml", seed=1, settings={"world.payload_mass_factor": factor})
    truth = flight.frame("truth")
    highest = -truth["payload_z_m"].min()
    error = flight.figures["position_rmse_m"]["total"]
    print(f"{factor}: {flight.outcome}, RMSE {error:.3f} m, up to {highest:.2f} m, {len(flight.alarms)} alarms")

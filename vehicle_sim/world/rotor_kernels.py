"""The lag and the wrenches of all vehicles' rotors over physics steps."""

from idc_controller.arrays import Array, Array2, Array3
from idc_controller.compiled import inlined, kernel


@inlined
def _advance(motor: Array, commands: Array, speeds: Array, j: int) -> float:
    """Return the force (N) of rotor ``j`` of a vehicle, and advance its speed: exact for a constant command."""
    speed, command = speeds[j], min(commands[j], motor[4])
    speeds[j] = command + (speed - command) * motor[0]
    force: float = motor[1] * speed * speed
    return force


@kernel
def advance_rotors(motors: Array2, commands: Array2, speeds: Array2, thrusts: Array2, torques: Array3) -> None:
    """Let ``speeds`` (N, 4) follow ``commands`` (N, 4) (rad/s) over K steps, exactly for commands that stay constant.

    ``motors`` (N, 5): decay of a difference over the step, thrust per squared speed (N s2), lever arm of roll and
    pitch (m), torque to thrust (m), largest speed (rad/s). Written are those at the beginning of each step:
    ``thrusts`` (K, N) (N) and ``torques`` (K, N, 3) (N m, FRD).
    """
    for k in range(thrusts.shape[0]):
        for i in range(commands.shape[0]):
            f_1 = _advance(motors[i], commands[i], speeds[i], 0)
            f_2 = _advance(motors[i], commands[i], speeds[i], 1)
            f_3 = _advance(motors[i], commands[i], speeds[i], 2)
            f_4 = _advance(motors[i], commands[i], speeds[i], 3)
            lever, torque_to_thrust = motors[i, 2], motors[i, 3]
            thrusts[k, i] = f_1 + f_2 + f_3 + f_4
            torques[k, i, 0] = lever * (f_2 + f_3 - f_1 - f_4)
            torques[k, i, 1] = lever * (f_1 + f_3 - f_2 - f_4)
            torques[k, i, 2] = torque_to_thrust * (f_1 + f_2 - f_3 - f_4)

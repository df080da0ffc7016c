"""The lag and the wrenches of all vehicles' rotors over physics steps."""

from idc_controller.arrays import Array
from idc_controller.compiled import inlined, kernel


@inlined
def _advance(motor: Array, commands: Array, speeds: Array, j: int) -> float:
    """Advance rotor ``j`` of a vehicle and return its mean force (N).

    Omega = c + d exp(-t / T): its square's mean over the step is c^2 + 2 c d mean_1 + d^2 mean_2.
    """
    c = min(commands[j], motor[6])
    d = speeds[j] - c
    speeds[j] = c + d * motor[0]
    force: float = motor[3] * (c * (c + motor[1] * d) + motor[2] * d * d)
    return force


@kernel("void(float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, :, ::1])")
def advance_rotors(motors: Array, commands: Array, speeds: Array, thrusts: Array, torques: Array) -> None:
    """Let ``speeds`` (N, 4) follow ``commands`` (N, 4) (rad/s) over K steps, exactly for commands that stay constant.

    ``motors`` (N, 7): decay of a difference over the step, twice the mean of exp(-t / T) over it, the mean of its
    square, thrust per squared speed (N s2), lever arm of roll and pitch (m), torque to thrust (m), largest speed
    (rad/s). Written are the means over each step: ``thrusts`` (K, N) (N) and ``torques`` (K, N, 3) (N m, FRD).
    """
    for k in range(thrusts.shape[0]):
        for i in range(commands.shape[0]):
            f_1 = _advance(motors[i], commands[i], speeds[i], 0)
            f_2 = _advance(motors[i], commands[i], speeds[i], 1)
            f_3 = _advance(motors[i], commands[i], speeds[i], 2)
            f_4 = _advance(motors[i], commands[i], speeds[i], 3)
            lever, torque_to_thrust = motors[i, 4], motors[i, 5]
            thrusts[k, i] = f_1 + f_2 + f_3 + f_4
            torques[k, i, 0] = lever * (f_2 + f_3 - f_1 - f_4)
            torques[k, i, 1] = lever * (f_1 + f_3 - f_2 - f_4)
            torques[k, i, 2] = torque_to_thrust * (f_1 + f_2 - f_3 - f_4)

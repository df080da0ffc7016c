"""The arithmetic of the onboard loop, for all vehicles of a team at once: samples, landing detection, attitude, mixer.

One row a vehicle, of arrays whose columns are named below. ``estimates`` and ``samples`` have rows of states as in
:mod:`vehicle_sim.world.state_kernels`; a row that begins with NaN says that there is none.
"""

import math

from idc_controller import rotations_float
from idc_controller.arrays import Array, Array1, Array2, Mask1
from idc_controller.compiled import inlined, kernel
from idc_controller.rotations_float import Quaternion, Vector
from vehicle_sim.autopilot.attitude_check_kernels import REFUSED_UNTIL, compare
from vehicle_sim.world.rotors import Four
from vehicle_sim.world.sensors import NORM_ERROR_MAX

# Columns of ``targets``: whether there is an attitude, the attitude (4), body rates (3) in rad/s, thrust (N).
HAS_ATTITUDE, ATTITUDE, RATES, THRUST = 0, 1, 5, 8
TARGET_COLUMNS = 9

# Columns of ``airframes``: inertia (xx, yy, zz, xy, xz, yz) in kg m2, twice kp (1/s2), kd (1/s), the largest force of a
# rotor (N), its force per torque about roll or pitch and about yaw (1/m), squared speed per thrust (1/(N s2)).
TWO_KP, KD, FORCE_MAX, PER_ROLL_PITCH, PER_YAW, PER_K_F = 6, 7, 8, 9, 10, 11

# Columns of ``landings``: what the detector has found; NaN: not known yet. Times in s, m, m/s, N. VELOCITY is that of
# the sensor, RATE that of the altitude, LIFT the thrust along the vertical, all low-passed; LAST_Z and LAST_V_Z are of
# the last sample; LIFTED_AT: when it lifted off.
(
    ALTITUDE, VELOCITY, GROUND, LAST_TIME, STANDING_SINCE, TOUCHING_SINCE, HOVER_THRUST, IN_AIR, RATE, LAST_Z, LAST_V_Z,
    LIFT, LIFTED_AT,
) = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12  # fmt: skip
LANDING_COLUMNS = 13

# Columns of ``detectors``: the vehicle's weight and largest thrust (N), gravity (m/s2), and settings of these names.
(
    WEIGHT, THRUST_MAX, LIFTED, VERTICAL_SPEED_MAX, TIME, TOUCHDOWN_THRUST, TOUCHDOWN_SINKING, VELOCITY_FILTER,
    ALTITUDE_FILTER, HOVER_FILTER, ALTITUDE_TOLERANCE, TIME_ELSEWHERE, GRAVITY,
) = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12  # fmt: skip

# Columns of ``stamps``: the time of the last fresh sample, and when it came (s); -inf: there has been none.
SAMPLE_TIME, FRESH_AT = 0, 1
STAMP_COLUMNS = 2

# How far a step has come: samples taken and not all fresh, landings detected and not all idle, rotor speeds commanded.
SAMPLED, DETECTED, COMMANDED = 0, 1, 2

_FAR = 1e6

_half_rotation = inlined(rotations_float.half_rotation)


@inlined
def landed(found: Array) -> None:
    """Take the vehicle to be on the ground here: armed, or disarmed."""
    found[GROUND] = found[ALTITUDE]
    found[IN_AIR] = 0.0
    found[STANDING_SINCE] = found[TOUCHING_SINCE] = math.inf


@kernel
def mixed_forces(
    thrust: float, tau_x: float, tau_y: float, tau_z: float, top: float, per_roll_pitch: float, per_yaw: float
) -> Four:
    """Return rotor forces (N), each within 0 .. ``top``, of a thrust (N) and body torques (N m, FRD).

    What cannot be done is given up in this order: yaw torque, then roll and pitch torque together (scaled, so that
    their direction stays); the thrust is kept.
    """
    level = min(max(thrust * 0.25, 0.0), top)
    roll, pitch, yaw = tau_x * per_roll_pitch, tau_y * per_roll_pitch, tau_z * per_yaw
    # Pairs on a diagonal get opposite shares of roll and pitch and the same share of yaw.
    first, third = pitch - roll, pitch + roll
    headroom = min(level, top - level)
    largest = max(abs(first), abs(third))
    if largest > headroom:
        scale = headroom / largest
        first *= scale
        third *= scale
    first_size, third_size = abs(first), abs(third)
    # +yaw on rotors 1 and 2 (level -+ first), -yaw on rotors 3 and 4 (level -+ third).
    yaw_headroom = headroom - max(first_size, third_size)
    if yaw > yaw_headroom:
        yaw = min(yaw, min(top - level - first_size, level - third_size))
    elif yaw < -yaw_headroom:
        yaw = -min(-yaw, min(top - level - third_size, level - first_size))
    return level + first + yaw, level - first + yaw, level + third - yaw, level - third - yaw


@kernel
def wanted_acceleration(
    attitude: Quaternion, rates: Vector, target: Quaternion, target_rates: Vector, two_kp: float, kd: float
) -> Vector:
    """Return the angular acceleration kp e - kd (omega - omega_target) (rad/s2), in the body frame.

    e = 2 sign(w) (x, y, z) of the rotation from the attitude to the target, in the body frame: their angle where it is
    small, the shorter way round, whichever sign either quaternion has. With ``two_kp`` 0 the rates alone count.
    """
    x = kd * (target_rates[0] - rates[0])
    y = kd * (target_rates[1] - rates[1])
    z = kd * (target_rates[2] - rates[2])
    if two_kp != 0.0:
        e_x, e_y, e_z = _half_rotation(attitude, target)
        x += two_kp * e_x
        y += two_kp * e_y
        z += two_kp * e_z
    return x, y, z


@kernel
def control_attitudes(
    airframes: Array2, estimates: Array2, targets: Array2, accelerations: Array2, speeds: Array2
) -> None:
    """Write rotor-speed commands ``speeds`` (N, 4) (rad/s) that turn vehicles to their ``targets``; 0 without thrust.

    ``accelerations`` (N, 3): the angular accelerations for which the torques are set (rad/s2).
    """
    for i in range(targets.shape[0]):
        t, s, a = targets[i], estimates[i], airframes[i]
        if t[THRUST] <= 0.0 or math.isnan(s[0]):
            accelerations[i] = 0.0
            speeds[i] = 0.0
            continue
        x, y, z = wanted_acceleration(
            (s[3], s[4], s[5], s[6]),
            (s[10], s[11], s[12]),
            (t[ATTITUDE], t[ATTITUDE + 1], t[ATTITUDE + 2], t[ATTITUDE + 3]),
            (t[RATES], t[RATES + 1], t[RATES + 2]),
            a[TWO_KP] if t[HAS_ATTITUDE] != 0.0 else 0.0,
            a[KD],
        )
        accelerations[i, 0], accelerations[i, 1], accelerations[i, 2] = x, y, z
        j_xx, j_yy, j_zz, j_xy, j_xz, j_yz = a[0], a[1], a[2], a[3], a[4], a[5]
        forces = mixed_forces(
            t[THRUST],
            j_xx * x + j_xy * y + j_xz * z,
            j_xy * x + j_yy * y + j_yz * z,
            j_xz * x + j_yz * y + j_zz * z,
            a[FORCE_MAX],
            a[PER_ROLL_PITCH],
            a[PER_YAW],
        )
        for k in range(4):
            speeds[i, k] = math.sqrt(forces[k] * a[PER_K_F]) if forces[k] > 0.0 else 0.0


@kernel
def take_fresh_samples(
    samples: Array2, times: Array1, now: float, last: Array2, estimates: Array2, stamps: Array2, fresh: Mask1,
    rate_checks: Array2,
) -> None:  # fmt: skip
    """Write which ``samples`` (N, 13) are ``fresh``: numbers, with a rotation for attitude, and no repeated ones.

    Fresh ones repeat neither position, nor attitude, nor rates of the ``last``. They are the new ``estimates`` (N, 13),
    with ``stamps`` (N, 2): the sample's of ``times`` (N,), and ``now`` (s). For the others :mod:`.navigation` decides:
    sensors repeat themselves by chance, or because they are stuck. Rates of zero are those of a vehicle at rest in a
    world without noise. Nor is a sample fresh whose rates are refused, by ``rate_checks`` (N, 17). All ``samples`` are
    then the ``last``.
    """
    for i in range(samples.shape[0]):
        s = samples[i]
        attitude, rates = s[3] + s[4] + s[5] + s[6], s[10] + s[11] + s[12]
        total = attitude + rates + (s[0] + s[1] + s[2]) + (s[7] + s[8] + s[9])
        norm = math.sqrt(s[3] * s[3] + s[4] * s[4] + s[5] * s[5] + s[6] * s[6])
        are_numbers = (
            math.isfinite(times[i])
            and abs(norm - 1.0) < NORM_ERROR_MAX
            and abs(attitude) < _FAR
            and abs(rates) < _FAR
            and abs(total) < _FAR
        )
        same_position, same_attitude, same_rates, still = True, True, True, True
        for k in range(3):
            same_position = same_position and s[k] == last[i, k]
        for k in range(3, 7):
            same_attitude = same_attitude and s[k] == last[i, k]
        for k in range(10, 13):
            same_rates = same_rates and s[k] == last[i, k]
            still = still and s[k] == 0.0
        if are_numbers and not same_attitude and (still or not same_rates):
            before = (last[i, 3], last[i, 4], last[i, 5], last[i, 6])
            compare(rate_checks[i], times[i], before, (s[3], s[4], s[5], s[6]), (s[10], s[11], s[12]))
            fresh[i] = (still or not same_position) and times[i] >= rate_checks[i, REFUSED_UNTIL]
        else:
            fresh[i] = False
        for k in range(s.shape[0]):
            last[i, k] = s[k]
            if fresh[i]:
                estimates[i, k] = s[k]
        if fresh[i]:
            stamps[i, SAMPLE_TIME], stamps[i, FRESH_AT] = times[i], now


@kernel
def detect_landings(
    detectors: Array2, estimates: Array2, targets: Array2, learns: Mask1, now: float,
    landings: Array2, idle_until: Array1,
) -> None:  # fmt: skip
    """Take one step of landing detection at ``now`` (s); see :class:`.land_detector.LandDetector`.

    The thrust is that of ``targets``; ``learns``: vehicles that fly set-points of the ground, and learn their hover
    thrust from it. Those that lift off or land are ``idle_until`` (N,) -inf: they have something to decide.
    """
    for i in range(landings.shape[0]):
        s, d, found, thrust = estimates[i], detectors[i], landings[i], targets[i, THRUST]
        if math.isnan(s[0]):
            continue
        step = now - found[LAST_TIME]
        found[LAST_TIME] = now
        z, v_z = s[2], s[9]
        if math.isnan(found[ALTITUDE]):
            found[ALTITUDE] = z
            continue
        behind = z - found[ALTITUDE]
        found[ALTITUDE] += behind * step / (d[ALTITUDE_FILTER] + step)
        found[RATE] += (behind / d[ALTITUDE_FILTER] - found[RATE]) * step / (d[VELOCITY_FILTER] + step)
        rise = (found[VELOCITY] - v_z) / (d[VELOCITY_FILTER] + step)  # acceleration upwards, of the same filter
        found[VELOCITY] -= rise * step
        x, y = s[4], s[5]
        found[LIFT] += (thrust * (1.0 - 2.0 * (x * x + y * y)) - found[LIFT]) * step / (d[VELOCITY_FILTER] + step)
        # What it carries moves with it, at any acceleration; in free fall nothing is known.
        carried = found[LIFT] * d[GRAVITY] / max(d[GRAVITY] + rise, 0.1 * d[GRAVITY])
        carried = min(max(carried, d[WEIGHT]), d[THRUST_MAX])
        if found[IN_AIR] == 0.0:
            if found[GROUND] - found[ALTITUDE] > d[LIFTED]:  # not where the ground is not known
                found[IN_AIR] = 1.0
                found[HOVER_THRUST], found[LIFTED_AT] = carried, now
                idle_until[i] = -math.inf
            continue
        if math.isnan(found[HOVER_THRUST]) or learns[i]:
            hover = carried if math.isnan(found[HOVER_THRUST]) else found[HOVER_THRUST]
            # The mean since lift-off, later low-passed.
            memory = min(d[VELOCITY_FILTER] + now - found[LIFTED_AT], d[HOVER_FILTER])
            found[HOVER_THRUST] = hover + (carried - hover) * step / (memory + step)
        # A position and velocity that repeat are no measurement, unless the vehicle is known to stand.
        stuck = z == found[LAST_Z] and v_z == found[LAST_V_Z] and v_z != 0.0
        found[LAST_Z], found[LAST_V_Z] = z, v_z
        sinks = max(found[VELOCITY], found[RATE]) > d[TOUCHDOWN_SINKING]
        if sinks or learns[i]:
            found[TOUCHING_SINCE] = math.inf
        elif thrust <= d[TOUCHDOWN_THRUST] * found[HOVER_THRUST] and not stuck:
            found[TOUCHING_SINCE] = min(found[TOUCHING_SINCE], now)
        if sinks or abs(found[VELOCITY]) >= d[VERTICAL_SPEED_MAX] or thrust > d[WEIGHT]:
            found[STANDING_SINCE] = math.inf
            continue
        found[STANDING_SINCE] = min(found[STANDING_SINCE], now)
        if stuck:
            found[STANDING_SINCE] += step
        at_home = abs(found[GROUND] - found[ALTITUDE]) < d[ALTITUDE_TOLERANCE]
        if now - found[STANDING_SINCE] >= (d[TIME] if at_home or learns[i] else d[TIME_ELSEWHERE]):
            landed(found)
            idle_until[i] = -math.inf


@kernel
def step_while_idle(
    samples: Array2,
    times: Array1,
    now: float,
    last: Array2,
    estimates: Array2,
    stamps: Array2,
    fresh: Mask1,
    detectors: Array2,
    targets: Array2,
    learns: Mask1,
    landings: Array2,
    idle_until: Array1,
    airframes: Array2,
    accelerations: Array2,
    speeds: Array2,
    rate_checks: Array2,
) -> int:
    """Take a step as far as no vehicle has to decide, and return how far that is: a stage above.

    It is :func:`take_fresh_samples`, :func:`detect_landings` and :func:`control_attitudes`, whose arguments these are.
    """
    take_fresh_samples(samples, times, now, last, estimates, stamps, fresh, rate_checks)
    for i in range(fresh.shape[0]):
        if not fresh[i]:
            return SAMPLED
    detect_landings(detectors, estimates, targets, learns, now, landings, idle_until)
    for i in range(idle_until.shape[0]):
        if idle_until[i] <= now:
            return DETECTED
    control_attitudes(airframes, estimates, targets, accelerations, speeds)
    return COMMANDED

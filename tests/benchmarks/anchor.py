"""The anchor of the speed figures: four small quadrotors in bare PyBullet, position PID at 48 Hz, physics at 240 Hz.

    python tests/benchmarks/anchor.py            gym-pybullet-drones' own loop if this Python has that package
    python tests/benchmarks/anchor.py --equal    the equal loop below, in any case

The loop is that of gym-pybullet-drones' `examples/pid.py` without logging and display: at every physics step four rotor
forces and one torque a vehicle, at every control step the state of each vehicle into an array of observations and a PID
controller of position and attitude on it. The equal loop makes the same PyBullet calls, on bodies of the same mass,
inertia, shape and links, and about the same calls of numpy and scipy. Prints one line of JSON.
"""

import argparse
import contextlib
import importlib.util
import json
import math
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

VEHICLES = 4
PHYSICS, CONTROL = 240, 48  # Hz
HEIGHT, RADIUS = 0.1, 0.3  # m
LAP = 10.0  # s
GRAVITY = 9.8  # m/s2
MASS = 0.027  # kg
THRUST_FACTOR, TORQUE_FACTOR = 3.16e-10, 7.94e-12  # N, N m per rpm2
RPM_MAX = 21702.64
REST = np.zeros(3)
ROTORS = ((0.028, -0.028), (-0.028, -0.028), (-0.028, 0.028), (0.028, 0.028))  # m


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--equal", action="store_true")
    parser.add_argument("--seconds", type=float, default=10.0, help="simulated time (default: %(default)s)")
    options = parser.parse_args()
    package = not options.equal and importlib.util.find_spec("gym_pybullet_drones") is not None
    with contextlib.redirect_stdout(sys.stderr):  # both print what they have loaded
        step, controllers = package_loop() if package else equal_loop()
    print(json.dumps({"loop": "gym-pybullet-drones" if package else "equal loop", **run(step, controllers, options)}))


def run(step, controllers, options):
    """Fly the circle; return CPU time per simulated second (ms), and the percentiles of a control step (ms)."""
    starts, yaws = start_poses()
    points = int(LAP * CONTROL)
    angle = np.arange(points) / points * 2.0 * np.pi + np.pi / 2.0
    circle = np.column_stack([RADIUS * np.cos(angle), RADIUS * np.sin(angle) - RADIUS, np.zeros(points)]) + starts[0]
    at = np.array([i * points // 6 % points for i in range(VEHICLES)])
    action = np.zeros((VEHICLES, 4))
    steps = np.empty(int(options.seconds * CONTROL))
    begin = time.process_time()
    for k in range(len(steps)):
        step_begin = time.thread_time()
        observed = step(action)
        for j, control in enumerate(controllers):
            target = np.hstack([circle[at[j], 0:2], starts[j, 2]])
            action[j] = control(observed[j], target, yaws[j])
            at[j] = at[j] + 1 if at[j] < points - 1 else 0
        steps[k] = time.thread_time() - step_begin
    spent = time.process_time() - begin
    error = max(float(np.linalg.norm(observed[j, :2] - circle[at[j] - 1, :2])) for j in range(VEHICLES))
    if not error < 0.2 or options.seconds < 5.0:
        raise SystemExit(f"the anchor does not fly its circle: {error:.2f} m off after {options.seconds} s")
    p50, p99, largest = np.percentile(steps * 1e3, [50, 99, 100]).tolist()
    return {"ms_per_second": spent / options.seconds * 1e3, "step_ms": {"p50": p50, "p99": p99, "max": largest}}


def start_poses():
    """Return positions (4, 3) (m) and roll, pitch, yaw (4, 3) (rad)."""
    turn = np.arange(VEHICLES) / 6.0 * 2.0 * np.pi + np.pi / 2.0
    heights = HEIGHT + 0.05 * np.arange(VEHICLES)
    starts = np.column_stack([RADIUS * np.cos(turn), RADIUS * np.sin(turn) - RADIUS, heights])
    return starts, np.array([[0.0, 0.0, i * (np.pi / 2.0) / VEHICLES] for i in range(VEHICLES)])


def package_loop():
    """Return step and controllers of gym-pybullet-drones itself."""
    from gym_pybullet_drones.control.DSLPIDControl import DSLPIDControl
    from gym_pybullet_drones.envs.CtrlAviary import CtrlAviary
    from gym_pybullet_drones.utils.enums import DroneModel, Physics

    starts, yaws = start_poses()
    model = DroneModel("cf2x")
    aviary = CtrlAviary(
        drone_model=model, num_drones=VEHICLES, initial_xyzs=starts, initial_rpys=yaws, physics=Physics("pyb"),
        neighbourhood_radius=10, pyb_freq=PHYSICS, ctrl_freq=CONTROL, gui=False, record=False, obstacles=False,
        user_debug_gui=False,
    )  # fmt: skip

    def controller():
        control = DSLPIDControl(drone_model=model).computeControlFromState
        period = aviary.CTRL_TIMESTEP
        return lambda state, target, rpy: control(
            control_timestep=period, state=state, target_pos=target, target_rpy=rpy
        )[0]

    return lambda action: aviary.step(action)[0], [controller() for _ in range(VEHICLES)]


# The equal loop


def equal_loop():
    """Return step and controllers of the equal loop."""
    world = Quadrotors(*start_poses())
    return world.step, [PositionControl() for _ in range(VEHICLES)]


def quadrotor():
    """A cylinder with four massless links at its rotors and a fifth in its middle, as URDF."""
    inertia = 'ixx="1.4e-5" ixy="0" ixz="0" iyy="1.4e-5" iyz="0" izz="2.17e-5"'
    massless = 'ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"'
    links = "".join(
        f'<link name="l{i}"><inertial><origin xyz="{x} {y} 0"/><mass value="0"/><inertia {massless}/></inertial></link>'
        f'<joint name="j{i}" type="fixed"><parent link="body"/><child link="l{i}"/></joint>'
        for i, (x, y) in enumerate((*ROTORS, (0.0, 0.0)))
    )
    return (
        f'<robot name="quadrotor"><link name="body"><inertial><mass value="{MASS}"/><inertia {inertia}/></inertial>'
        '<collision><geometry><cylinder radius="0.06" length="0.025"/></geometry></collision></link>'
        f"{links}</robot>"
    )


class Quadrotors:
    """Quadrotors above a plane, and their states as last read."""

    def __init__(self, positions, angles):
        import pybullet
        import pybullet_data

        self.engine = p = pybullet
        self.client = client = p.connect(p.DIRECT)
        p.setGravity(0, 0, -GRAVITY, physicsClientId=client)
        p.setRealTimeSimulation(0, physicsClientId=client)
        p.setTimeStep(1.0 / PHYSICS, physicsClientId=client)
        p.setAdditionalSearchPath(pybullet_data.getDataPath(), physicsClientId=client)
        p.loadURDF("plane.urdf", physicsClientId=client)
        descriptor, path = tempfile.mkstemp(suffix=".urdf")
        with os.fdopen(descriptor, "w") as file:
            file.write(quadrotor())
        self.bodies = np.array([
            p.loadURDF(
                path, position, p.getQuaternionFromEuler(angle), flags=p.URDF_USE_INERTIA_FROM_FILE,
                physicsClientId=client,
            )
            for position, angle in zip(positions, angles, strict=True)
        ])  # fmt: skip
        Path(path).unlink()
        n = len(self.bodies)
        self.position, self.quaternion, self.angles = np.zeros((n, 3)), np.zeros((n, 4)), np.zeros((n, 3))
        self.velocity, self.rates, self.rpm = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 4))
        self.read()

    def step(self, action):
        """Hold the rotor speeds (4, 4) (rpm) for a control period; return the observations (4, 20)."""
        rpm = np.reshape(np.array([np.clip(action[i, :], 0, RPM_MAX) for i in range(len(self.bodies))]), (-1, 4))
        for _ in range(PHYSICS // CONTROL):
            for i in range(len(self.bodies)):
                self.actuate(i, rpm[i, :])
            self.engine.stepSimulation(physicsClientId=self.client)
            self.rpm = rpm
        self.read()
        return np.array([self.observation(i) for i in range(len(self.bodies))])

    def actuate(self, i, rpm):
        p = self.engine
        forces, torques = np.array(rpm**2) * THRUST_FACTOR, np.array(rpm**2) * TORQUE_FACTOR
        torque = -torques[0] + torques[1] - torques[2] + torques[3]
        for rotor in range(4):
            p.applyExternalForce(
                self.bodies[i], rotor, forceObj=[0, 0, forces[rotor]], posObj=[0, 0, 0], flags=p.LINK_FRAME,
                physicsClientId=self.client,
            )  # fmt: skip
        p.applyExternalTorque(
            self.bodies[i], 4, torqueObj=[0, 0, torque], flags=p.LINK_FRAME, physicsClientId=self.client
        )

    def read(self):
        p = self.engine
        for i, body in enumerate(self.bodies):
            self.position[i], self.quaternion[i] = p.getBasePositionAndOrientation(body, physicsClientId=self.client)
            self.angles[i] = p.getEulerFromQuaternion(self.quaternion[i])
            self.velocity[i], self.rates[i] = p.getBaseVelocity(body, physicsClientId=self.client)

    def observation(self, i):
        parts = [self.position[i, :], self.quaternion[i, :], self.angles[i, :], self.velocity[i, :], self.rates[i, :]]
        return np.hstack([*parts, self.rpm[i, :]]).reshape(20)


class PositionControl:
    """PID control of position, and of attitude by rotation matrices; gains of a 27 g quadrotor, PWM of its motors."""

    P, I, D = np.array([0.4, 0.4, 1.25]), np.array([0.05, 0.05, 0.05]), np.array([0.2, 0.2, 0.5])
    ATTITUDE_P, ATTITUDE_I = np.array([7e4, 7e4, 6e4]), np.array([0.0, 0.0, 500.0])
    ATTITUDE_D = np.array([2e4, 2e4, 1.2e4])
    MIXER = np.array([[-0.5, -0.5, -1.0], [-0.5, 0.5, 1.0], [0.5, 0.5, -1.0], [0.5, -0.5, 1.0]])
    RPM_PER_PWM, RPM_OFFSET = 0.2685, 4070.3

    def __init__(self):
        import pybullet
        from scipy.spatial.transform import Rotation

        self.engine, self.rotation = pybullet, Rotation
        self.summed, self.summed_rotation, self.last = np.zeros(3), np.zeros(3), np.zeros(3)

    def __call__(self, state, target, yaw, velocity=REST, rates=REST):
        """Return the rotor speeds (4,) (rpm) for an observation (20,)."""
        quaternion = state[3:7]
        thrust, angles = self.command(state[0:3], quaternion, state[10:13], target, yaw, velocity)
        speeds = self.follow(thrust, quaternion, angles, rates)
        self.yaw_error = angles[2] - self.engine.getEulerFromQuaternion(quaternion)[2]
        return speeds

    def command(self, position, quaternion, flown, target, yaw, velocity):
        """Return the thrust (PWM) and the angles (3,) (rad) that lead to the target."""
        body = np.array(self.engine.getMatrixFromQuaternion(quaternion)).reshape(3, 3)
        off, slow = target - position, velocity - flown
        self.summed = self.summed + off * (1.0 / CONTROL)
        self.summed = np.clip(self.summed, -2.0, 2.0)
        self.summed[2] = np.clip(self.summed[2], -0.15, 0.15)
        force = np.multiply(self.P, off) + np.multiply(self.I, self.summed) + np.multiply(self.D, slow)
        force = force + np.array([0.0, 0.0, GRAVITY * MASS])
        lift = max(0.0, np.dot(force, body[:, 2]))
        thrust = (math.sqrt(lift / (4 * THRUST_FACTOR)) - self.RPM_OFFSET) / self.RPM_PER_PWM
        up = force / np.linalg.norm(force)
        heading = np.array([math.cos(yaw[2]), math.sin(yaw[2]), 0.0])
        left = np.cross(up, heading) / np.linalg.norm(np.cross(up, heading))
        forward = np.cross(left, up)
        commanded = np.vstack([forward, left, up]).transpose()
        angles = self.rotation.from_matrix(commanded).as_euler("XYZ", degrees=False)
        if np.any(np.abs(angles) > math.pi):
            raise ValueError("angles beyond half a turn")
        return thrust, angles

    def follow(self, thrust, quaternion, angles, rates):
        """Return the rotor speeds (4,) (rpm) that turn the body to ``angles`` (3,) (rad)."""
        body = np.array(self.engine.getMatrixFromQuaternion(quaternion)).reshape(3, 3)
        now = np.array(self.engine.getEulerFromQuaternion(quaternion))
        x, y, z, w = self.rotation.from_euler("XYZ", angles, degrees=False).as_quat()
        commanded = self.rotation.from_quat([x, y, z, w]).as_matrix()
        error = np.dot(commanded.transpose(), body) - np.dot(body.transpose(), commanded)
        turned = np.array([error[2, 1], error[0, 2], error[1, 0]])
        slow = rates - (now - self.last) / (1.0 / CONTROL)
        self.last = now
        self.summed_rotation = self.summed_rotation - turned * (1.0 / CONTROL)
        self.summed_rotation = np.clip(self.summed_rotation, -1500.0, 1500.0)
        self.summed_rotation[0:2] = np.clip(self.summed_rotation[0:2], -1.0, 1.0)
        torques = np.multiply(self.ATTITUDE_D, slow) - np.multiply(self.ATTITUDE_P, turned)
        torques = np.clip(torques + np.multiply(self.ATTITUDE_I, self.summed_rotation), -3200, 3200)
        pwm = np.clip(thrust + np.dot(self.MIXER, torques), 20000, 65535)
        return self.RPM_PER_PWM * pwm + self.RPM_OFFSET


if __name__ == "__main__":
    main()

"""The command vehicle-sim impair: refused arguments, and a link between two sockets of this machine."""

import signal
import socket
import subprocess
import sys
import threading

import pytest
from programs import PATIENCE, base_port, swarm_process

from gcs.mavlink.address import ConnectionUrl
from vehicle_sim.app.cli import main
from vehicle_sim.app.ending import Ending
from vehicle_sim.app.impair import LinkDriver, LinkSockets
from vehicle_sim.app.impair_arguments import parse_impair
from vehicle_sim.faults.impaired_link import ImpairedLink
from vehicle_sim.faults.link_profiles import PROFILES, LinkDirection, LinkProfile

HERE = "127.0.0.1"


def program(port=0):
    """The socket of a MAVLink program, at a free port of this machine."""
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.bind((HERE, port))
    made.settimeout(PATIENCE)  # for a link that lost everything: a test that hangs says nothing
    return made


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ("--profile sik", "the following arguments are required: LISTEN, FORWARD"),
        ("127.0.0.1:14550 127.0.0.1:14560", "needs --profile (sik, lte, wifi, satcom), or a value such as --loss 0.1"),
        ("--profile 5g 127.0.0.1:14550 127.0.0.1:14560", "argument --profile: invalid choice: '5g'"),
        ("--profle sik 127.0.0.1:14550", "did you mean --profile?"),
        ("--loss 1.5 127.0.0.1:14550 127.0.0.1:14560", "--loss: '1.5' is not a number from 0 to 1"),
        ("--loss 0.1,x 127.0.0.1:14550 127.0.0.1:14560", "--loss: 'x' is not a number from 0 to 1"),
        ("--rate 0 127.0.0.1:14550 127.0.0.1:14560", "--rate: '0' is not a number from 1 to 1e+09"),
        ("--burst 1 127.0.0.1:14550 127.0.0.1:14560", "--burst: without effect where there is no loss; add --loss"),
        ("--loss 0.1,0 --burst 1 127.0.0.1:14550 127.0.0.1:14560", "--burst: without effect where there is no loss"),
        ("--queue 9 127.0.0.1:14550 127.0.0.1:14560", "--queue: without effect where there is no rate; add --rate"),
        ("--profile sik 127.0.0.1 127.0.0.1:14560", "LISTEN udpin://127.0.0.1: expected "),
        ("--profile sik udpout://127.0.0.1:14550 127.0.0.1:14560", "LISTEN udpout://127.0.0.1:14550: listens; "),
        ("--profile sik 127.0.0.1:14550 127.0.0.1:70000", "FORWARD udpout://127.0.0.1:70000: expected "),
        ("--profile sik 127.0.0.1:14550 127.0.0.1:14550", "FORWARD 127.0.0.1:14550: port 14550 is one of LISTEN's"),
        ("--profile sik --links 4 127.0.0.1:14550 127.0.0.1:14553", "port 14553 is one of LISTEN's"),
        ("--profile sik --links 4 127.0.0.1:65533 127.0.0.1:14553", "LISTEN 127.0.0.1:65533: port 65536 of link 4"),
        ("--profile sik --seed -1 127.0.0.1:14550 127.0.0.1:14560", "--seed: '-1'"),
    ],
)
def test_refused_arguments_give_one_line(capsys, arguments, reason):
    assert main(["impair", *arguments.split()]) == 2
    out, errors = capsys.readouterr()
    assert out == "" and errors.count("\n") == 1 and reason in errors


def test_address_in_use_is_refused(capsys):
    with program() as other:
        port = other.getsockname()[1]
        assert main(["impair", "--profile", "sik", f"{HERE}:{port}", f"{HERE}:14560"]) == 2
    assert capsys.readouterr() == (
        "",
        f"vehicle-sim impair: cannot listen on udp://{HERE}:{port}: Address already in use\n",
    )


def test_values_change_those_of_the_profile_in_each_direction():
    options = parse_impair(
        ["--profile", "lte", "--loss", "0.2", "--latency", "0.3,0.1", f"{HERE}:14550", f"{HERE}:14560"]
    )
    telemetry, command = options.profile.telemetry, options.profile.command
    assert (telemetry.loss, command.loss) == (0.2, 0.2) and (telemetry.latency, command.latency) == (0.3, 0.1)
    assert telemetry.rate == PROFILES["lte"].telemetry.rate and command.jitter == PROFILES["lte"].command.jitter
    assert options.name == "lte, loss 0.2, latency 0.3,0.1"


def test_links_are_on_ports_that_follow_one_another():
    options = parse_impair(["--profile", "wifi", "--links", "3", f"{HERE}:14580", f"udp://{HERE}:14680"])
    assert [(listen[1], forward.port) for listen, forward in options.addresses] == [
        (14580, 14680), (14581, 14681), (14582, 14682)
    ]  # fmt: skip


def test_driver_hands_on_datagrams_both_ways():
    ending = Ending()
    with program() as vehicle, program() as ground:
        forward = ConnectionUrl(*ground.getsockname(), listens=False)
        profile = LinkProfile(*2 * [LinkDirection(latency=0.001, jitter=0.001)])
        link = ImpairedLink(profile, [7, 1], forward=forward.address)
        with LinkSockets((HERE, 0), forward) as sockets:
            running = threading.Thread(target=LinkDriver([(link, sockets)], ending).run)
            running.start()
            try:
                for i in range(20):
                    vehicle.sendto(b"telemetry %d" % i, sockets.at["listen"].getsockname())
                    data, sender = ground.recvfrom(100)
                    assert data == b"telemetry %d" % i
                    ground.sendto(b"command %d" % i, sender)
                    assert vehicle.recvfrom(100) == (b"command %d" % i, sockets.at["listen"].getsockname())
            finally:
                ending.request()
                running.join()
    ending.close()
    assert link.counts["telemetry"].forwarded == link.counts["command"].forwarded == 20


def test_program_starts_without_kernels_and_prints_its_counts_at_ctrl_c():
    listen = base_port()
    with program() as ground, program() as vehicle:
        arguments = ("impair", "--latency", "0.001", f"udpin://{HERE}:{listen}")
        with swarm_process(*arguments, f"udpout://{HERE}:{ground.getsockname()[1]}") as running:
            announced = [running.stdout.readline() for _ in range(3)]
            assert announced[1:] == ["ready\n", "(no profile, latency 0.001, seed 1; Ctrl-C ends)\n"]
            vehicle.sendto(b"x", (HERE, listen))
            ground.sendto(b"y", ground.recvfrom(100)[1])
            assert vehicle.recv(100) == b"y"
            running.send_signal(signal.SIGINT)
            out, errors = running.communicate(timeout=PATIENCE)
            assert running.returncode == 130 and errors == ""
    counts = "1 received, 1 forwarded, 0 lost, 0 lost at the queue, 0 late, 0 reordered"
    assert out == f"link 1: telemetry: {counts}\nlink 1: command: {counts}\n"


def test_start_imports_neither_the_physics_engine_nor_compiled_kernels():
    code = (
        "import sys; from vehicle_sim.app.cli import main; main(['impair', '--profile', 'sik', 'a', 'b']);"
        "print(sorted({'numba', 'pybullet', 'scipy'} & set(sys.modules)), 'vehicle_sim.app.impair' in sys.modules)"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out == "[] True\n"

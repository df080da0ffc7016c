"""A ground station for tests of the drivers."""

VEHICLE = ("127.0.0.1", 14541)


class ScriptedStation:
    """It ends its flight after so many exchanges, and sends the vehicle a datagram in each of them."""

    def __init__(self, exchanges):
        self.exchanges = exchanges
        self.times, self.received, self.failsafes = [], [], []

    @property
    def ended(self):
        return len(self.times) >= self.exchanges

    def receive_all(self, datagrams, now):
        self.received += [(datagram, sender, now) for datagram, sender in datagrams]

    def datagrams_to_send(self, now):
        self.times.append(now)
        return [(b"command", VEHICLE)]

    def raise_failsafe(self, now, failsafe, reason):
        self.failsafes.append((now, failsafe, reason))

    def resume(self):
        pass

    sent = resume

"""An instrument without *ESE for the program sinstruments: it answers what it knows and is silent to the rest."""

import itertools

import gevent


class Plain:
    baudrate = None

    def __init__(self, name, **_):
        self.name = name
        self.readings = itertools.count(1)
        gevent.spawn(self.announce)

    def announce(self):
        self.transports[0].start()
        print(self.transports[0].server_port, flush=True)

    def get_protocol(self, channel, transport):
        return Lines(self, channel, transport)

    def reply(self, line):
        if line == b"READ?":
            return str(next(self.readings)).encode()
        known = {b"*IDN?": b"ACME,Plain,8,1.0", b"*ESR?": b"0", b"SYST:ERR?": b'0,"No error"'}
        return known.get(line)


class Lines:
    def __init__(self, device, channel, transport):
        self.device, self.channel, self.transport = device, channel, transport

    def handle(self):
        for line in self.transport.ireadlines(self.channel):
            reply = self.device.reply(line.strip())
            if reply is not None:
                self.transport.send(self.channel, reply + b"\n")

"""Serves an instrument with scpipy, whose own status system answers *ESE, *ESR? and SYST:ERR?.

serve.py PORT: 0 chooses a free port. The first line of stdout is the port. READ? returns 1, 2, 3 and so on.
"""

import itertools
import sys

from scpipy.server import Context, Router, Server

router = Router()
readings = itertools.count(1)


@router.register("*IDN?")
def identity(context: Context):
    return "ACME,Counter,7,1.0"


@router.register("READ?")
def read(context: Context):
    return next(readings)


class Announced(Server):
    async def _wait_stop(self):
        print(self._server.sockets[0].getsockname()[1], flush=True)
        await super()._wait_stop()


# Like an instrument, it keeps its registers when a connection ends.
server = Announced("127.0.0.1", int(sys.argv[1]), shared_context=True)
server.include_router(router)
server.run()

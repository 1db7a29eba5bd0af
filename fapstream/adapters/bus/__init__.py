"""The bus that carries a talk from the process in which it is spoken to those whose listeners watch it.

`LocalBus`: one process. `Hub` in a parent and `HubBus` in each of its processes: one machine, nothing to
install. `redis_bus.RedisBus`: several machines. `open_bus` takes an address.
"""

from fapstream.adapters.bus.hub import Hub
from fapstream.adapters.bus.local import LocalBus
from fapstream.adapters.bus.opening import open_bus
from fapstream.adapters.bus.worker import HubBus

__all__ = ["Hub", "HubBus", "LocalBus", "open_bus"]

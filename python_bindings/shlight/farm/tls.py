# SPDX-License-Identifier: MIT
"""Encryption and mutual authentication of all connections."""

from __future__ import annotations

from dataclasses import dataclass
from ipaddress import ip_address
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit


def is_loopback(address: str) -> bool:
    """Whether a scheduler's address, such as tcp://127.0.0.1:8786 or localhost:8786, is on this machine."""
    parts = urlsplit(address if "://" in address else f"tcp://{address}")
    if parts.scheme == "inproc" or parts.hostname == "localhost":
        return True
    try:
        return ip_address(parts.hostname or "").is_loopback
    except ValueError:  # a name, which may be anywhere
        return False


@dataclass(frozen=True)
class Tls:
    """PEM files: the authority that has signed the certificates of all, the own certificate, and its key."""

    ca: str
    cert: str
    key: str

    def check(self) -> None:
        """Raises OSError naming a file that cannot be read."""
        for path in (self.ca, self.cert, self.key):
            with Path(path).open("rb"):
                pass

    def security(self) -> Any:
        """Dask's security object; scheduler, workers and client of a cluster on this machine share the certificate."""
        from distributed.security import Security

        roles = ("scheduler", "worker", "client")
        own = {f"tls_{role}_cert": self.cert for role in roles} | {f"tls_{role}_key": self.key for role in roles}
        return Security(tls_ca_file=self.ca, require_encryption=True, **own)

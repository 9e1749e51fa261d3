"""A provider of sign-ins (OpenID Connect) for one test: it lets in whoever presses its button."""

import json
import secrets
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlencode, urlsplit

from joserfc import jwt
from joserfc.jwk import RSAKey

CLIENT = "evdash-test"
EMAIL = "planner@example.org"
BUTTON = "Let me in"


class Provider(ThreadingHTTPServer):
    """Its key, and the nonces asked for by the codes it gave out."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Answers)
        self.address = f"http://127.0.0.1:{self.server_address[1]}"
        self.key = RSAKey.generate_key(2048, {"kid": "of this test"}, auto_kid=False)
        self.nonces: dict[str, str] = {}

    def token(self, nonce: str) -> str:
        """What says who signed in, signed."""
        now = int(time.time())
        claims = {"iss": self.address, "aud": CLIENT, "sub": "1", "email": EMAIL}
        times = {"iat": now, "exp": now + 600, "nonce": nonce}
        return jwt.encode({"alg": "RS256", "kid": self.key.kid}, claims | times, self.key)


class Answers(BaseHTTPRequestHandler):
    """The five addresses the protocol needs."""

    server: Provider

    def do_GET(self) -> None:
        """Metadata, keys, the page with the button, and the way back with a code."""
        url, own = urlsplit(self.path), self.server.address
        asked = {name: values[0] for name, values in parse_qs(url.query).items()}
        if url.path == "/.well-known/openid-configuration":
            self._json(
                {
                    "issuer": own,
                    "authorization_endpoint": f"{own}/authorize",
                    "token_endpoint": f"{own}/token",
                    "jwks_uri": f"{own}/keys",
                    "response_types_supported": ["code"],
                    "id_token_signing_alg_values_supported": ["RS256"],
                }
            )
        elif url.path == "/keys":
            self._json({"keys": [self.server.key.as_dict(private=False)]})
        elif url.path == "/authorize":
            href = escape(f"/enter?{url.query}")
            self._answer(200, "text/html", f'<a href="{href}">{BUTTON}</a>'.encode())
        elif url.path == "/enter":
            code = secrets.token_urlsafe()
            self.server.nonces[code] = asked.get("nonce", "")
            back = urlencode({"code": code, "state": asked["state"]})
            self._answer(302, "text/html", b"", f"{asked['redirect_uri']}?{back}")
        else:  # the browser's wish for an icon
            self._answer(204, "text/plain", b"")

    def do_POST(self) -> None:
        """A code for a token, once."""
        body = self.rfile.read(int(self.headers["Content-Length"])).decode()
        nonce = self.server.nonces.pop(parse_qs(body)["code"][0])
        token = self.server.token(nonce)
        self._json({"access_token": "none", "token_type": "Bearer", "id_token": token})

    def _json(self, content: dict[str, Any]) -> None:
        self._answer(200, "application/json", json.dumps(content).encode())

    def _answer(self, status: int, kind: str, body: bytes, goes_to: str = "") -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        if goes_to:
            self.send_header("Location", goes_to)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: Any) -> None:
        """Nothing on standard error."""


@contextmanager
def provider() -> Iterator[Provider]:
    """A provider on a free port of this machine."""
    with Provider() as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server
        server.shutdown()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A small S3 for tests, written from the documents of AWS: checks signatures and SHA-256, and answers wrongly when a test wants it.

    s3_server.py FOLDER [CERTIFICATE KEY]    listens on a free port of 127.0.0.1, which it writes to FOLDER/port

Objects are files in FOLDER/objects, each upload in parts is a folder in FOLDER/uploads. FOLDER/fault holds "METHOD FAULT": requests with this
method ("*": all) are answered wrongly. FOLDER/requests has a line for each request."""
import hashlib
import hmac
import os
import shutil
import ssl
import sys
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import parse_qsl, quote, unquote, urlsplit
from xml.etree import ElementTree
from xml.sax.saxutils import escape

ACCESS_KEY, SECRET_KEY, REGION, BUCKET = "tester", "a-secret+of/tests", "eu-test-1", "recordings"
FOLDER = Path(sys.argv[1])
OBJECTS, UPLOADS = FOLDER / "objects", FOLDER / "uploads"
SILENCE_S = 40.0
PAGE = 1000


def sign(key: bytes, text: str) -> bytes:
    return hmac.new(key, text.encode(), hashlib.sha256).digest()


def etag_of(data: bytes) -> str:
    return f'"{hashlib.md5(data).hexdigest()}"'


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_: object) -> None:
        pass

    def do_GET(self) -> None:
        self.handle_request()

    do_HEAD = do_PUT = do_POST = do_DELETE = do_GET

    def handle_request(self) -> None:
        self.body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        parts = urlsplit(self.path)
        self.query = dict(parse_qsl(parts.query, keep_blank_values=True))
        with (FOLDER / "requests").open("a") as log:
            log.write(f"{self.command} {self.path}\n")
        method, _, fault = (FOLDER / "fault").read_text().strip().partition(" ") if (FOLDER / "fault").exists() else ("", "", "")
        self.fault = fault if method in ("*", self.command) else ""
        if self.fault == "silence":
            self.say_nothing()
        elif self.fault.isdecimal():
            self.fail(int(self.fault), "Told", "the test wants this status")
        elif self.fault == "oversized":
            self.answer(500, b"<Error><Code>" + b"x" * (8 << 20) + b"</Code></Error>")
        elif self.fault == "truncated":
            self.send_response(200)
            self.send_header("Content-Length", "1000")
            self.send_header("ETag", '"truncated"')
            self.end_headers()
            self.wfile.write(b"<half")
            self.close_connection = True
        elif not self.is_signed(parts.path, parts.query):
            self.fail(403, "SignatureDoesNotMatch", "the signature is another one")
        elif self.fault != "unchecked" and hashlib.sha256(self.body).hexdigest() != self.headers.get("x-amz-content-sha256"):
            self.fail(400, "XAmzContentSHA256Mismatch", "the body has another SHA-256")
        else:
            bucket, _, key = unquote(parts.path).removeprefix("/").partition("/")
            if bucket != BUCKET:
                self.fail(404, "NoSuchBucket", "there is no such bucket")
            else:
                self.serve(key)

    def say_nothing(self) -> None:
        time.sleep(SILENCE_S)
        self.close_connection = True

    def is_signed(self, path: str, query: str) -> bool:
        words = dict(word.partition("=")[::2] for word in self.headers.get("Authorization", "").removeprefix("AWS4-HMAC-SHA256 ").split(", "))
        words |= dict(word.partition("=")[::2] for word in self.headers.get("Authorization", "").removeprefix("AWS4-HMAC-SHA256 ").split(","))
        words = {name.strip(): value.strip() for name, value in words.items()}
        key, day, region, service, end = (words.get("Credential", "").split("/") + [""] * 5)[:5]
        names = words.get("SignedHeaders", "").split(";")
        if key != ACCESS_KEY or (region, service, end) != (REGION, "s3", "aws4_request") or not {"host", "x-amz-content-sha256"} <= set(names):
            return False
        pairs = sorted((quote(name, safe="-_.~"), quote(value, safe="-_.~")) for name, value in parse_qsl(query, keep_blank_values=True))
        canonical = "\n".join([self.command, quote(unquote(path), safe="/-_.~"), "&".join(f"{name}={value}" for name, value in pairs),
                               *(f"{name}:{' '.join(self.headers.get(name, '').split())}" for name in names), "", ";".join(names),
                               self.headers.get("x-amz-content-sha256", "")])
        to_sign = "\n".join(["AWS4-HMAC-SHA256", self.headers.get("x-amz-date", ""), f"{day}/{region}/{service}/{end}",
                             hashlib.sha256(canonical.encode()).hexdigest()])
        secret = sign(sign(sign(sign(f"AWS4{SECRET_KEY}".encode(), day), region), service), end)
        return hmac.compare_digest(hmac.new(secret, to_sign.encode(), hashlib.sha256).hexdigest(), words.get("Signature", ""))

    def serve(self, key: str) -> None:
        stored = OBJECTS / key.replace("/", "%")
        match self.command:
            case "GET" if not key:
                self.list()
            case "POST" if "uploads" in self.query:
                upload = f"upload/~{time.time_ns()}="
                (UPLOADS / upload.replace("/", "%")).mkdir()
                self.answer(200, f"<InitiateMultipartUploadResult><UploadId>{upload}</UploadId></InitiateMultipartUploadResult>".encode())
            case "PUT" | "POST" | "DELETE" if "uploadId" in self.query:
                self.serve_parts(stored, UPLOADS / self.query["uploadId"].replace("/", "%"))
            case "PUT":
                if self.fault != "lost":
                    self.store(stored, self.body)
                self.answer(200, b"", '"0123"' if self.fault == "etag" else None if self.fault == "no-etag" else etag_of(self.body))
            case "HEAD" if not key:
                self.answer(200)
            case "HEAD" | "GET":
                if not stored.exists():
                    self.fail(404, "NoSuchKey", "there is no such object")
                    return
                if self.fault == "stored-silence":  # not when a hub asks before it sends
                    self.say_nothing()
                    return
                data = stored.read_bytes()
                if self.fault == "size":
                    data += b"x"
                etag = Path(f"{stored}.etag")
                self.answer(200, data, etag.read_text() if etag.exists() else etag_of(data))
            case "DELETE":
                stored.unlink(missing_ok=True)
                Path(f"{stored}.etag").unlink(missing_ok=True)
                self.answer(204)

    def serve_parts(self, stored: Path, upload: Path) -> None:
        if not upload.is_dir():
            self.fail(404, "NoSuchUpload", "there is no such upload")
        elif self.command == "DELETE":
            shutil.rmtree(upload)
            self.answer(204)
        elif self.command == "PUT":
            (upload / f"{int(self.query['partNumber']):05}").write_bytes(self.body)
            self.answer(200, b"", '"0123"' if self.fault == "etag" else etag_of(self.body))
        else:
            wanted = [(part.findtext("PartNumber"), part.findtext("ETag")) for part in ElementTree.fromstring(self.body)]
            found = [(str(int(part.name)), etag_of(part.read_bytes())) for part in sorted(upload.iterdir())]
            if wanted != found or self.fault == "late-error":
                self.answer(200, b"<Error><Code>InvalidPart</Code><Message>a part is another one</Message></Error>")
                return
            sums = b"".join(hashlib.md5(part.read_bytes()).digest() for part in sorted(upload.iterdir()))
            etag = f'"{hashlib.md5(sums).hexdigest()}-{len(found)}"'
            self.store(stored, b"".join(part.read_bytes() for part in sorted(upload.iterdir())))
            Path(f"{stored}.etag").write_text(etag)
            shutil.rmtree(upload)
            if self.fault == "unanswered":
                self.close_connection = True
                return
            blanks = " \r\n \r\n"  # S3 sends them while it puts the parts together
            self.answer(200, f"""{blanks}<?xml version="1.0" encoding="UTF-8"?>
<CompleteMultipartUploadResult><ETag>{escape(etag)}</ETag></CompleteMultipartUploadResult>""".encode())

    def list(self) -> None:
        keys = sorted(file.name.replace("%", "/") for file in OBJECTS.iterdir() if file.suffix not in (".etag", ".new"))
        keys = [key for key in keys if key.startswith(self.query.get("prefix", "")) and key > self.query.get("start-after", "")]
        page = 2 if self.fault == "small-pages" else PAGE
        more = len(keys) > page
        text = "".join(f"<Contents><Key>{escape(key)}</Key><Size>1</Size></Contents>" for key in keys[:page])
        self.answer(200, (f'<ListBucketResult xmlns="http://s3.amazonaws.com/doc/2006-03-01/"><IsTruncated>'
                          f'{"true" if more or self.fault == "endless" else "false"}</IsTruncated>{text}</ListBucketResult>').encode())

    @staticmethod
    def store(stored: Path, data: bytes) -> None:
        new = Path(f"{stored}.new")
        new.write_bytes(data)
        Path(f"{stored}.etag").unlink(missing_ok=True)
        os.replace(new, stored)

    def fail(self, status: int, code: str, text: str) -> None:
        self.answer(status, f"<Error><Code>{code}</Code><Message>{text}</Message></Error>".encode())

    def answer(self, status: int, body: bytes = b"", etag: str | None = None) -> None:
        self.send_response(status)
        self.send_header("Content-Length", str(len(body)))
        if etag:
            self.send_header("ETag", etag)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)


class Server(ThreadingHTTPServer):
    def handle_error(self, *_: object) -> None:
        """A client that was killed, or that stopped reading, is part of the tests."""


def main() -> None:
    for folder in (OBJECTS, UPLOADS):
        folder.mkdir(exist_ok=True)
    server = Server(("127.0.0.1", int(os.environ.get("S3_PORT", "0"))), Handler)
    if len(sys.argv) > 3:
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(sys.argv[2], sys.argv[3])
        server.socket = context.wrap_socket(server.socket, server_side=True)
    (FOLDER / "port.new").write_text(str(server.server_address[1]))
    (FOLDER / "port.new").rename(FOLDER / "port")
    server.serve_forever()


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: Apache-2.0
"""The document itself: SPDX 2.3 in JSON (spdx.github.io/spdx-spec/v2.3), and the notices that licences want passed on."""
import dataclasses
import datetime
import hashlib
import json
import os
import re
from typing import Any, Protocol


class Component(Protocol):
    name: str
    version: str
    licence: str
    supplier: str
    checksum: str | None

    @property
    def purl(self) -> str: ...
    @property
    def notice(self) -> str: ...


@dataclasses.dataclass(frozen=True)
class Part:
    component: Any
    relation: str  # DYNAMIC_LINK, STATIC_LINK, CONTAINS, DEPENDS_ON, BUILD_TOOL_OF


def identifier(component: Component) -> str:
    kind = component.purl.removeprefix("pkg:").split("/")[0]
    return f"SPDXRef-{kind}-{re.sub('[^A-Za-z0-9.-]', '-', component.name).strip('-')}"


def package_entry(component: Component) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "SPDXID": identifier(component),
        "name": component.name,
        "versionInfo": component.version,
        "supplier": component.supplier,
        "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False,
        "licenseConcluded": "NOASSERTION",
        "licenseDeclared": component.licence,
        "copyrightText": "NOASSERTION",
        "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": component.purl}],
    }
    if component.checksum:
        entry["checksums"] = [{"algorithm": "SHA512", "checksumValue": component.checksum}]
    return entry


def relationship(subject: str, part: Part) -> dict[str, str]:
    other = identifier(part.component)
    if part.relation == "BUILD_TOOL_OF":
        subject, other = other, subject
    return {"spdxElementId": subject, "relationshipType": part.relation, "relatedSpdxElement": other}


def document(package: str, version: str, parts: list[Part]) -> str:
    subject = f"SPDXRef-{package}"
    main = {
        "SPDXID": subject,
        "name": package,
        "versionInfo": version,
        "supplier": "NOASSERTION",
        "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False,
        "licenseConcluded": "NOASSERTION",
        "licenseDeclared": "Apache-2.0",
        "copyrightText": "NOASSERTION",
    }
    entries = {identifier(part.component): package_entry(part.component) for part in parts}
    relationships = [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": subject}]
    relationships += [relationship(subject, part) for part in parts]
    packages = [main, *(entries[name] for name in sorted(entries))]
    content = hashlib.sha256(json.dumps([packages, relationships], sort_keys=True).encode()).hexdigest()
    created = datetime.datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), datetime.UTC)
    whole = {
        "spdxVersion": "SPDX-2.3",
        "dataLicense": "CC0-1.0",
        "SPDXID": "SPDXRef-DOCUMENT",
        "name": f"{package}-{version}",
        "documentNamespace": f"https://spdx.org/spdxdocs/{package}-{version}-{content[:32]}",
        "creationInfo": {"created": created.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Tool: dtsd-packaging-sbom"]},
        "packages": packages,
        "relationships": relationships,
    }
    return json.dumps(whole, indent=1) + "\n"


def notices(components: list[Component]) -> str:
    texts = [f"{each.name} {each.version}\n{'=' * 80}\n\n{each.notice.strip()}\n" for each in components]
    return "Code of others that is part of this package, and its licences.\n\n\n" + "\n\n".join(texts)

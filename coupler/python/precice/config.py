"""Names and dimensions out of a precice-config.xml. Its coupling scheme is not read: the case file of Strake has its own."""
import pathlib
import xml.etree.ElementTree as tree
from dataclasses import dataclass, field
from xml.parsers import expat

from strake.errors import nearest

from .errors import Error

YES = {"true", "yes", "on", "1"}


@dataclass
class Data:
    name: str
    is_vector: bool
    degree: int = 1  # of the polynomial in time


@dataclass
class MeshOf:
    name: str
    dimensions: int
    data: list


@dataclass
class Configuration:
    """What one participant of a precice-config.xml may do.

    provided    meshes of its own by name; received: names of meshes that others provide
    read, write pairs of mesh and data
    initial     names of data that it writes before the first window
    histories   whether data that it reads comes with samples inside a window
    mappings   of all participants: mesh that it leads from, mesh that it leads to, whether sums are kept
    readings   of all participants: pairs of mesh and data that are read
    projects    names of meshes from or onto which a mapping projects, and so looks at faces
    is_implicit   whether windows may be computed again; so it is where the file holds no scheme of this participant
    """

    file: str
    participant: str
    data: dict = field(default_factory=dict)
    meshes: dict = field(default_factory=dict)
    provided: list = field(default_factory=list)
    received: list = field(default_factory=list)
    read: list = field(default_factory=list)
    write: list = field(default_factory=list)
    initial: set = field(default_factory=set)
    histories: bool = False
    mappings: list = field(default_factory=list)
    readings: set = field(default_factory=set)
    projects: set = field(default_factory=set)
    is_implicit: bool = True

    def mesh(self, name, function):
        """A provided mesh; Error where the participant has none of that name."""
        if name in self.provided:
            return self.meshes[name]
        if name in self.received:
            raise Error(f'{function}(): the mesh "{name}" is received; Strake gives access to own meshes alone')
        raise Error(f'{function}(): {self.participant} has no mesh "{name}"; {nearest(name, self.provided)}')

    def data_of(self, mesh, name, function, listed, verb):
        """Data of a mesh that the participant reads or writes; Error where it does not."""
        self.mesh(mesh, function)
        if (mesh, name) in listed:
            return self.data[name]
        names = [data for owner, data in listed if owner == mesh]
        raise Error(f'{function}(): {self.participant} {verb} no data "{name}" on "{mesh}"; {nearest(name, names)}')

    def coupled(self):
        """The meshes of its own that have data, in the file's order."""
        used = {mesh for mesh, _ in self.read + self.write}
        return [name for name in self.provided if name in used]

    def is_conservative(self, mesh, data):
        """Whether data sent from a mesh keep their sum. Where mappings from it differ, that to a mesh on which they are read counts."""
        kept = {to: keeps for start, to, keeps in reversed(self.mappings) if start == mesh}  # of two the first
        return next((keeps for to, keeps in kept.items() if (to, data) in self.readings),
                    next((keeps for start, _, keeps in self.mappings if start == mesh), False))

    def used_mesh(self, name, function):
        """A mesh of its own or one that it receives; Error where it is neither."""
        used = self.provided + self.received
        if name in used:
            return self.meshes[name]
        raise Error(f'{function}(): {self.participant} has no mesh "{name}"; {nearest(name, used)}')


def load(file):
    """The file as a tree. Its tags hold colons that are no namespaces, which xml.etree alone does not read."""
    builder, parser = tree.TreeBuilder(), expat.ParserCreate()
    parser.StartElementHandler = lambda tag, attributes: builder.start(tag, attributes)
    parser.EndElementHandler = builder.end
    try:
        parser.Parse(pathlib.Path(file).read_bytes(), True)
    except OSError as e:
        raise Error(f"{file}: cannot be read: {e.strerror}") from None
    except expat.ExpatError as e:
        raise Error(f"{file}:{e.lineno}:{e.offset + 1}: {expat.errors.messages[e.code]}") from None
    return builder.close()


def read_configuration(file, participant):
    """The part of a precice-config.xml that one participant needs; Error where it has no such participant."""
    root = load(file)
    found = Configuration(str(file), participant)
    for element in root.iter():
        kind, _, form = element.tag.partition(":")
        if kind == "data" and form in ("scalar", "vector"):
            found.data[need(element, "name", file)] = Data(element.get("name"), form == "vector", int(element.get("waveform-degree", 1)))
    for element in root.iter("mesh"):
        dimensions = element.get("dimensions", "")
        if dimensions not in ("2", "3"):
            raise Error(f'{file}: the mesh "{element.get("name")}" has dimensions="{dimensions}", expected 2 or 3')
        found.meshes[need(element, "name", file)] = MeshOf(
            element.get("name"), int(dimensions), [use.get("name") for use in element.iter("use-data")])
    own = {p.get("name"): p for p in root.iter("participant") if len(p)}
    if participant not in own:
        raise Error(f'{file}: there is no participant "{participant}"; {nearest(participant, own)}')
    read_own(own[participant], found)
    read_exchanges(root, found)
    read_constraints(root, found)
    read_scheme(root, found)
    return found


def need(element, attribute, file):
    value = element.get(attribute)
    if not value:
        raise Error(f'{file}: <{element.tag}> has no {attribute}="…"')
    return value


def read_own(element, found):
    for part in element:
        if part.tag in ("provide-mesh", "receive-mesh"):
            name = need(part, "name", found.file)
            if name not in found.meshes:
                raise Error(f'{found.file}: <{part.tag} name="{name}">: there is no such mesh; {nearest(name, found.meshes)}')
            (found.provided if part.tag == "provide-mesh" else found.received).append(name)
        elif part.tag in ("read-data", "write-data"):
            mesh, data = need(part, "mesh", found.file), need(part, "name", found.file)
            if data not in found.data:
                raise Error(f'{found.file}: <{part.tag} name="{data}">: there is no such data; {nearest(data, found.data)}')
            (found.read if part.tag == "read-data" else found.write).append((mesh, data))


def read_exchanges(root, found):
    reads = {data for _, data in found.read}
    for exchange in root.iter("exchange"):
        if exchange.get("from") == found.participant and exchange.get("initialize", "").lower() in YES:
            found.initial.add(exchange.get("data"))
        if exchange.get("to") == found.participant and exchange.get("data") in reads:
            found.histories |= exchange.get("substeps", "").lower() in YES


def read_constraints(root, found):
    for mapping in root.iter():
        if mapping.tag.startswith("mapping:"):
            found.mappings.append((mapping.get("from"), mapping.get("to"), mapping.get("constraint") == "conservative"))
        if mapping.tag == "read-data":
            found.readings.add((mapping.get("mesh"), mapping.get("name")))
        if mapping.tag in ("mapping:nearest-projection", "mapping:linear-cell-interpolation"):
            found.projects |= {mapping.get("from"), mapping.get("to")}


def read_scheme(root, found):
    for scheme in root.iter():
        if scheme.tag.startswith("coupling-scheme:"):
            names = [value for part in scheme for key, value in part.attrib.items() if part.tag in ("participants", "participant")]
            if found.participant in names:
                found.is_implicit = scheme.tag.endswith(("-implicit", ":multi"))

"""The messages of proto/coupling.proto as Python knows them: the module coupling_pb2, made by the build."""
import pathlib
import sys

from .errors import Error, need


def find_messages():
    """Imports coupling_pb2. `strake run` puts its folder on PYTHONPATH; else it lies beside this package or the programs."""
    need("google.protobuf", "python3-protobuf")
    try:
        import coupling_pb2
    except ModuleNotFoundError:
        folder = next((f for f in candidates() if (f / "coupling_pb2.py").exists()), None)
        if folder is None:
            raise Error("coupling_pb2.py, the messages for Python, is not found",
                        "ninja strake_python makes it in build/python; put that folder on PYTHONPATH", exit_code=2) from None
        sys.path.append(str(folder))
        import coupling_pb2
    return coupling_pb2


def candidates():
    from .programs import find_program
    yield pathlib.Path(__file__).resolve().parent.parent
    try:
        prefix = find_program().resolve().parent.parent
    except Error:
        return
    yield from (prefix / "python", prefix / "share" / "strake" / "python")


pb = find_messages()

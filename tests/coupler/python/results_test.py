"""Results of a run in Python, from folders that the test writes: results_test.py FOLDER_OF_strake FOLDER_OF_precice"""
import fcntl
import json
import os
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

sys.path[:0] = [sys.argv.pop(1), sys.argv.pop(1)]
import h5py  # noqa: E402
import numpy as np  # noqa: E402
import strake  # noqa: E402
from strake import programs  # noqa: E402

HISTORY = "window [1],time [s],mid.x [m],mid.y [m],p_mid [Pa]\n1,0.1,0,-1e-3,\n# resumed\n2,0.2,0,inf,5\n3,0.3,0,2e-3,6"
SUMMARY = {"exit_code": 0, "checks": {"work_gap": 1e-12, "lost": 0, "grades": {"work_gap": {"grade": "good", "good": 1e-6, "poor": 0.05}}},
           "alarms": [{"kind": "speed", "text": "too fast"}],
           "compare": [{"probe": "mid.y", "metric": "peak", "value": 1.1, "reference": 1.0, "tolerance": 0.05, "pass": False, "kind": "theory", "source": "book"},
                       {"probe": "mid.y", "metric": "final", "value": None, "reference": 0, "tolerance": 1e-3, "pass": None, "kind": "code", "source": "other"}]}
SIDE_BY_SIDE = {name: None for name in ("pandas", "xarray", "matplotlib")}  # as if they were not installed


def installed(module):
    try:
        __import__(module)
        return True
    except ImportError:
        return False


def write_frame(path, time, form="strake frame 1"):
    with h5py.File(path, "w") as file:
        file.attrs["format"], file.attrs["time"] = form, time
        for name, value, unit in (("position", np.arange(6.0).reshape(2, 3), "m"), ("point/pressure", np.array([[1.0], [2.0]]), "Pa"),
                                  ("point/a%2Fb", np.ones((2, 3)), "1")):
            file[name] = value
            file[name].attrs["unit"] = unit
        file["cells"] = np.arange(2)[:, None]
        file.create_group("cell")


def write_block(path, windows, form="strake archive 1", velocity=True):
    n = 2
    with h5py.File(path, "w") as file:
        file.attrs["format"] = form
        file["integer/mesh"], file["integer/faces"] = np.array([[2], [2], [1]]), np.array([[0], [1]])
        real = {"position": np.arange(6.0).reshape(2, 3).T, "initial_displacement": np.zeros((3, n)), "time": [[0.1 * w for w in windows]],
                "dt": [[0.1] * len(windows)], "displacement": [[100 * w + k for w in windows] for k in range(3 * n)],
                "fluid.pressure": [[w + 0.5 * k for w in windows] for k in range(n)]}
        if velocity:
            real["velocity"] = real["displacement"]
        for name, value in real.items():
            file[f"real/{name}"] = np.array(value, float)
            file[f"real/{name}"].attrs["unit"] = "m" if "displacement" in name else "Pa"


class Results(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.place = pathlib.Path(place.name)
        self.folder = self.place / "plate"
        for name in ("frames", "interface"):
            (self.folder / name).mkdir(parents=True)
        self.write("run.json", json.dumps({"strake": "0.1.0", "exit_code": 0}))
        self.write("history.csv", HISTORY)
        self.write("summary.json", json.dumps(SUMMARY))
        hidden = mock.patch.dict(sys.modules, SIDE_BY_SIDE)
        hidden.start()
        self.addCleanup(hidden.stop)

    def write(self, name, text):
        (self.folder / name).write_text(text)

    def open(self):
        return strake.open(self.folder)

    def refused(self, call, *words, code=None):
        with self.assertRaises(strake.Error) as caught:
            call()
        for word in words:
            self.assertIn(word, str(caught.exception))
        if code is not None:
            self.assertEqual(caught.exception.exit_code, code)

    def test_a_table_without_its_unfinished_line_and_notes(self):
        run = self.open()
        self.assertEqual(list(run.history), ["window", "time", "mid.x", "mid.y", "p_mid"])
        self.assertEqual(run.column("mid.y").tolist(), [-1e-3, float("inf")])
        self.assertTrue(np.isnan(run.column("p_mid")[0]))
        self.assertEqual((run.units["p_mid"], run.units["window"]), ("Pa", "1"))

    def test_a_column_that_is_not_there_is_answered_with_the_nearest(self):
        run = self.open()
        self.refused(lambda: run.column("mid"), "history.csv", 'no column is named "mid"; did you mean "mid.')
        self.refused(lambda: run.history["p_mdi"], 'did you mean "p_mid"?')
        self.refused(lambda: run.column("xyz"), "there are window, time, mid.x")

    def test_a_damaged_table_is_told_with_its_line(self):
        self.write("history.csv", "time [s],y [m]\n0,1\n0,1,2\n")
        self.refused(lambda: self.open().history, "history.csv:3", "3 values in a table of 2 columns", code=3)
        self.write("history.csv", "")
        self.refused(lambda: self.open().history, "holds no columns", code=3)

    def test_references_with_their_verdicts(self):
        first, second = self.open().references
        self.assertEqual((first.name, first.kind, first.source, first.value, first.measured, first.tolerance, first.verdict),
                         ("mid.y peak", "theory", "book", 1.0, 1.1, 0.05, "outside"))
        self.assertAlmostEqual(first.deviation, 0.1)
        self.assertEqual((second.verdict, second.deviation), ("not reached", None))
        self.assertEqual(self.open().alarms, ["too fast"])
        self.assertEqual(self.open().checks, {"work_gap": {"value": 1e-12, "grade": "good", "good": 1e-6, "poor": 0.05},
                                              "lost": {"value": 0, "grade": None, "good": None, "poor": None}})

    def test_an_unfinished_run_is_read_as_far_as_it_goes(self):
        (self.folder / "summary.json").unlink()
        case = self.place / "plate.toml"
        case.write_text('[[compare]]\nprobe = "mid.y"\nvalue = { peak = 1.0 }\ntolerance = { peak = 0.1 }\nkind = "theory"\nsource = "book"\n')
        self.write("run.json", json.dumps({"case": str(case)}))
        run = self.open()
        self.assertEqual((run.state, run.summary, run.checks, len(run.column("time"))), ("killed", {}, {}, 2))
        self.assertEqual([(r.name, r.value, r.measured, r.verdict) for r in run.references], [("mid.y peak", 1.0, None, "not judged")])
        self.write("history.csv", HISTORY + "\n")
        self.assertEqual(len(run.column("time")), 2)
        self.assertEqual(len(run.reload().column("time")), 3)
        (self.folder / "history.csv").unlink()
        self.refused(lambda: self.open().history, "history.csv", "is not there: the run killed", code=3)
        descriptor = os.open(self.folder, os.O_RDONLY)
        self.addCleanup(os.close, descriptor)
        fcntl.flock(descriptor, fcntl.LOCK_EX)  # as a run does
        self.assertEqual(self.open().state, "running")

    def test_states_of_a_run_that_has_ended(self):
        for code, state in ((1, "finished"), (130, "stopped"), (5, "failed: structure: was killed")):
            self.write("run.json", json.dumps({"exit_code": code, "error": {"where": "structure", "problem": "was killed"}}))
            self.assertEqual(self.open().state, state)

    def test_what_is_no_run_is_refused(self):
        self.refused(lambda: strake.open(self.place / "plat"), "is no folder", "holds plate", code=2)
        self.refused(lambda: strake.open(self.place), "is no run folder", "it holds runs: name one, such as", code=2)
        self.write("summary.json", "{")
        self.refused(lambda: self.open().summary, "summary.json: cannot be read", code=3)
        self.refused(lambda: strake.open_study(self.folder), "is no study", code=2)

    def test_frames_by_side_and_time(self):
        for k, time in enumerate((0.0, 0.1, 0.2)):
            write_frame(self.folder / "frames" / f"fluid-{k:06}.h5", time)
        (self.folder / "frames" / "fluid-000003.h5").write_bytes(b"cut off")
        frames = self.open().frames["fluid"]
        self.assertEqual(frames.times.tolist(), [0.0, 0.1, 0.2])
        frame = frames.at(0.15)
        self.assertEqual((frame["time"], frame["pressure"].tolist(), frame["a/b"].shape, frame.units["pressure"]), (0.1, [1, 2], (2, 3), "Pa"))
        self.assertEqual(len(frames[1:]), 2)
        self.refused(lambda: self.open().frames["structure"], 'no frames of "structure"', "there are fluid", code=2)
        self.refused(lambda: frame["presure"], 'did you mean "pressure"?', code=2)
        with self.assertRaises(IndexError):
            frames[3]

    def test_a_frame_of_several_ranks_needs_all_its_parts(self):
        parts = self.folder / "frames" / "fluid-000000"
        parts.mkdir()
        for k in range(2):
            write_frame(parts / f"{k:04}.h5", 0.0)
        with h5py.File(f"{parts}.h5", "w", libver="latest") as file:
            file.attrs["format"], file.attrs["time"] = "strake frame 1", 0.0
            for name, columns, kind in (("position", 3, "f8"), ("point/pressure", 1, "f8"), ("cells", 1, "i8")):
                layout = h5py.VirtualLayout((4, columns), kind)
                for k in range(2):
                    layout[2 * k:2 * k + 2] = h5py.VirtualSource(f"fluid-000000/{k:04}.h5", name, (2, columns))
                file.create_virtual_dataset(name, layout)
            file["parts"] = [[(parts / f"{k:04}.h5").stat().st_size] for k in range(2)]
        frames = self.open().frames["fluid"]
        self.assertEqual(frames[0]["pressure"].tolist(), [1, 2, 1, 2])
        part = parts / "0001.h5"
        part.write_bytes(part.read_bytes() + b"more")
        self.refused(lambda: frames[0], "0001.h5 has", "bytes, not", code=3)
        part.unlink()
        self.refused(lambda: frames[0], "its part", "0001.h5 is missing", code=3)

    def test_the_interface_of_all_blocks(self):
        self.refused(lambda: self.open().interface, "has no recorded interface", code=3)
        write_block(self.folder / "interface" / "000001.h5", [0, 1])
        write_block(self.folder / "interface" / "000002.h5", [2], velocity=False)
        found = self.open().interface
        self.assertTrue(np.allclose(found["time"], [0.1, 0.2, 0.3]))
        self.assertEqual(found["displacement"].shape, (3, 2, 3))
        self.assertEqual(found["displacement"][2, 1].tolist(), [203, 204, 205])
        self.assertEqual(found["fluid.pressure"].tolist(), [[0, 0.5], [1, 1.5], [2, 2.5]])
        self.assertEqual((found["faces"].tolist(), found["position"][1].tolist()), ([[0, 1]], [3, 4, 5]))
        self.assertNotIn("velocity", found)

    def test_a_file_of_another_version_is_refused(self):
        write_frame(self.folder / "frames" / "fluid-000000.h5", 0, "strake frame 2")
        write_frame(self.folder / "frames" / "fluid-000001.h5", 1)
        self.refused(lambda: self.open().frames, 'has the format "strake frame 2", expected "strake frame 1"', code=3)
        write_block(self.folder / "interface" / "000001.h5", [0], "strake archive 7")
        self.refused(lambda: self.open().interface, '"strake archive 7"', "version that wrote it", code=3)

    def test_what_is_not_installed_is_named_with_its_package(self):
        self.refused(lambda: self.open().plot("mid.y"), "apt-get install python3-matplotlib", code=2)
        write_frame(self.folder / "frames" / "fluid-000000.h5", 0)
        with mock.patch.dict(sys.modules, {"h5py": None}):
            self.refused(lambda: self.open().frames["fluid"][0], "apt-get install python3-h5py", code=2)


class Installed(Results):
    """The same folder with what Debian has beside numpy, where it is installed."""

    def setUp(self):
        with mock.patch.dict(SIDE_BY_SIDE, clear=True):
            super().setUp()

    @unittest.skipUnless(installed("pandas"), "python3-pandas is not installed")
    def test_a_table_is_a_data_frame(self):
        history = self.open().history
        self.assertEqual((type(history).__name__, history.shape, history.attrs["units"]["p_mid"]), ("DataFrame", (2, 5), "Pa"))

    @unittest.skipUnless(installed("xarray"), "python3-xarray is not installed")
    def test_fields_are_data_sets(self):
        write_block(self.folder / "interface" / "000001.h5", [0, 1])
        found = self.open().interface
        self.assertEqual((found["displacement"].dims, found["displacement"].attrs["units"]), (("time", "point", "xyz"), "m"))
        self.assertEqual(float(found["displacement"].sel(time=0.2, xyz="y")[1]), 104)

    @unittest.skipUnless(installed("matplotlib"), "python3-matplotlib is not installed")
    def test_a_plot_has_a_curve_for_each_component(self):
        axes = self.open().plot("mid", file=self.place / "mid.png")
        self.assertEqual([line.get_label() for line in axes.get_lines()], ["mid.x [m]", "mid.y [m]", "mid.y peak, theory", "mid.y final, code"])
        self.assertTrue((self.place / "mid.png").read_bytes().startswith(b"\x89PNG"))


for _name in [n for n in dir(Results) if n.startswith("test_") and n not in vars(Installed)]:
    setattr(Installed, _name, None)  # they are done without


class Programs(unittest.TestCase):
    def test_settings_are_written_as_toml(self):
        words = programs.settings({"a.b": 0.1, "c": True, "d": [1, 2.5], "e": float("inf"), "f": "fem", "g": np.float64(3), "h": [["x"]]})
        self.assertEqual(words[1::2], ["a.b=0.1", "c=true", "d=[1, 2.5]", "e=inf", "f=fem", "g=3.0", 'h=[["x"]]'])
        self.assertEqual(programs.settings(["a=1"]), ["--set", "a=1"])
        with self.assertRaisesRegex(strake.Error, "a = None is a NoneType"):
            programs.settings({"a": None})

    def test_a_program_that_is_not_there_is_told(self):
        with mock.patch.dict(os.environ, {"STRAKE_BIN": "/nowhere"}), self.assertRaisesRegex(strake.Error, "/nowhere .STRAKE_BIN."):
            programs.find_program()

    def test_words_and_exit_code_of_the_program_are_the_error(self):
        with tempfile.TemporaryDirectory() as place:
            program = pathlib.Path(place) / "strake"
            program.write_text("#!/bin/sh\necho '{\"kind\": \"error\"}'\necho 'case.toml:3: no such key' >&2\nexit 3\n")
            program.chmod(0o755)
            heard = []
            with mock.patch.dict(os.environ, {"STRAKE_BIN": place}), self.assertRaises(strake.Error) as caught:
                strake.run("case.toml", follow=heard.append)
        self.assertEqual((str(caught.exception), caught.exception.exit_code, heard), ("case.toml:3: no such key", 3, [{"kind": "error"}]))

    def test_an_interrupt_ends_the_program_in_order(self):
        with tempfile.TemporaryDirectory() as place:
            program = pathlib.Path(place) / "strake"
            program.write_text(f"#!/bin/sh\ntrap 'echo once >>{place}/signals; kill %1; exit 130' INT TERM\necho ready\nsleep 60 & wait\n")
            program.chmod(0o755)

            def interrupt(line):
                raise KeyboardInterrupt

            with mock.patch.dict(os.environ, {"STRAKE_BIN": place}), self.assertRaises(KeyboardInterrupt):
                strake.study("study.toml", follow=interrupt)
            self.assertEqual((pathlib.Path(place) / "signals").read_text(), "once\n")


unittest.main()

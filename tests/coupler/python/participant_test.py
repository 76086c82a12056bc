"""A solver derived from strake.Participant, asked by a toy coupler: participant_test.py FOLDER_OF_strake FOLDER_OF_precice"""
import os
import sys
import tempfile
import unittest

sys.path[:0] = [sys.argv.pop(1), sys.argv.pop(1)]
import numpy as np  # noqa: E402
import strake  # noqa: E402
import zmq  # noqa: E402
from strake.connection import Connection  # noqa: E402
from strake.options import Options  # noqa: E402
from toy_coupler import ToyCoupler, pb  # noqa: E402

BEGIN = """
import numpy as np
import strake
class Solver(strake.Participant):
    def build(self, key):
        self.points, self.faces = [(0, 0), (1, 0), (1, 1)], [(0, 1), (1, 2), (2, 0)]
        self.state, self.columns = {"y": np.zeros(2), "n": 0}, {"n": "1"}
        {build}
    def advance(self, t, dt, load):
        {advance}
        self.state["y"] += dt * load["force"][:, 1].sum()
        self.state["n"] += 1
        self.monitor["n"] = self.state["n"]
        return 0, self.state["y"][0]
Solver.main()
"""
CASE = "[structure.solver]\nmass = 2.0\n"
LOAD = np.array([[0, 1.0, 0]] * 3)


def script(build="pass", advance="pass"):
    return BEGIN.replace("{build}", build).replace("{advance}", advance)


class Participant(unittest.TestCase):
    def begin(self, text, case=CASE, keys=None, **environment):
        coupler = ToyCoupler(keys=keys)
        self.addCleanup(coupler.close)
        coupler.start(text, case=case, **environment)
        self.said = coupler.hello()
        return coupler

    def fault(self, coupler, reply, *words, code=4):
        """The reply is a fault that says these words, and the process ends with the same code."""
        self.assertEqual(reply.WhichOneof("what"), "fault", reply)
        text = f"{reply.fault.where}: {reply.fault.problem} {reply.fault.fix}"
        for word in words:
            self.assertIn(word, text)
        self.assertEqual(reply.fault.exit_code, code)
        printed = coupler.printed()
        self.assertEqual(coupler.process.returncode, code, printed)
        return printed

    def test_says_who_it_is_and_what_it_has(self):
        coupler = self.begin(script())
        self.assertEqual((self.said.protocol, self.said.name, self.said.solver), (1, "structure", "solver"))
        self.assertEqual((len(self.said.token), len(self.said.case_hash)), (16, 32))
        reply, arrays = coupler.setup()
        ready = reply.ready
        self.assertEqual((ready.mesh.n_points, ready.mesh.n_faces, ready.mesh.dimension), (3, 3, 2))
        self.assertEqual([(f.quantity, f.unit, f.components) for f in ready.initial], [("displacement", "m", 3)])
        self.assertEqual([(c.name, c.unit) for c in ready.columns], [("n", "1")])
        self.assertEqual([len(a) for a in arrays], [72, 24, 72])
        self.assertEqual(np.frombuffer(arrays[0]).reshape(3, 3)[2].tolist(), [1, 1, 0])
        coupler.stop()
        self.assertEqual(coupler.printed(), "")
        self.assertEqual(coupler.process.returncode, 0)

    def test_computes_each_window_from_the_last_accepted_state(self):
        coupler = self.begin(script())
        coupler.setup()
        found = []
        for t, before in ((0, "NOTHING"), (0, "REWIND"), (0, "REWIND"), (1, "COMMIT"), (1, "REWIND")):
            reply, arrays = coupler.advance(t, 1.0, LOAD, before)
            found.append((np.frombuffer(arrays[0]).reshape(3, 3)[1, 1], reply.advanced.monitor["n"]))
        self.assertEqual(found, [(3, 1), (3, 1), (3, 1), (6, 2), (6, 2)])
        self.assertTrue(np.isinf(reply.advanced.dt_limit))
        self.assertGreater(reply.times.answered, reply.times.received)
        coupler.stop()

    def test_writes_and_reads_checkpoints_of_the_accepted_state(self):
        coupler = self.begin(script())
        coupler.setup()
        coupler.advance(0, 1.0, LOAD)
        folder = str(coupler.folder)
        reply, _ = coupler.ask(checkpoint=pb.Checkpoint(folder=folder, before=pb.Advance.COMMIT))
        self.assertEqual(reply.WhichOneof("what"), "done")
        first = (coupler.folder / "structure.npz").read_bytes()
        coupler.advance(1, 1.0, LOAD)
        coupler.ask(checkpoint=pb.Checkpoint(folder=folder, resume=True))
        reply, _ = coupler.advance(1, 1.0, LOAD)
        self.assertEqual(reply.advanced.monitor["n"], 2)
        coupler.ask(checkpoint=pb.Checkpoint(folder=folder, before=pb.Advance.REWIND))
        self.assertEqual((coupler.folder / "structure.npz").read_bytes(), first)
        np.savez(coupler.folder / "structure.npz", y=np.zeros(5))
        reply, _ = coupler.ask(checkpoint=pb.Checkpoint(folder=folder, resume=True))
        self.fault(coupler, reply, "has the shape", "--force", code=3)

    def test_names_the_line_of_an_exception(self):
        coupler = self.begin(script(advance="raise ValueError('the stiffness is singular')"))
        coupler.setup()
        reply, _ = coupler.advance(0, 1.0, LOAD)
        printed = self.fault(coupler, reply, "solver.py:10, in advance", "ValueError: the stiffness is singular")
        self.assertIn("Traceback", printed)

    def test_names_its_own_line_where_a_package_raises(self):
        coupler = self.begin(script(advance="np.linalg.solve(np.zeros((2, 2)), np.ones(2))"))
        coupler.setup()
        reply, _ = coupler.advance(0, 1.0, LOAD)
        self.fault(coupler, reply, "solver.py:10, in advance", "LinAlgError: Singular matrix")

    def test_an_error_of_its_own_keeps_place_words_and_code(self):
        coupler = self.begin(script(build="raise strake.Error('no such material', 'use steel', 'case.toml:3', 3)"))
        reply, _ = coupler.setup()
        self.fault(coupler, reply, "case.toml:3: no such material use steel", code=3)

    def alone(self, **parts):
        """The solver in this process, without a coupler."""
        names = {}
        exec(script(**parts).replace("Solver.main()", ""), names)
        return names["Solver"].alone({"mass": 2.0})

    def test_refuses_what_it_cannot_send(self):
        for advance, words in (("return 0, float('nan')", "displacement is nan at point 0"),
                               ("return np.zeros((4, 3))", r"displacement has the shape \(4, 3\), expected \(3, 3\)"),
                               ("return self.state['n'] + 1", r"displacement has the shape \(\), expected \(3, 3\)"),
                               ("return np.ones((3, 1))", r"displacement has the shape \(3, 1\), expected \(3, 3\)"),
                               ("return {'velocity': 0}", "returned velocity, expected displacement"),
                               ("return None", r"advance\(\) returned None, expected displacement"),
                               ("return {'displacement': None}", "displacement is NoneType, expected numbers"),
                               ("return '0'", "displacement is str, expected numbers")):
            solver = self.alone(advance=advance)
            with self.assertRaisesRegex(strake.Error, words):
                solver.checked(solver.advance(0, 1.0, {"force": LOAD}))

    def test_refuses_a_monitor_that_no_column_takes(self):
        coupler = self.begin(script(advance="self.monitor['tip.y'] = 1.0"))
        coupler.setup()
        reply, _ = coupler.advance(0, 1.0, LOAD)
        self.fault(coupler, reply, 'self.monitor["tip.y"] is no column', 'self.columns = {"tip.y": "1"}')

    def test_a_load_without_a_partner_is_zero(self):
        coupler = self.begin(script(advance="self.monitor['n:load'] = np.abs(load['force']).sum() + len(load['force'])"))
        coupler.setup()
        reply, arrays = coupler.ask(advance=pb.Advance(t=0, dt=1))
        self.assertEqual(reply.WhichOneof("what"), "advanced", reply)
        self.assertEqual((reply.advanced.monitor["n:load"], np.frombuffer(arrays[0]).tolist()), (3, [0.0] * 9))
        coupler.stop()

    def test_refuses_a_mesh_that_is_none(self):
        for build, words in (("self.faces = [(0, 3)]", "a face names point 3, the points are 0 to 2"),
                             ("self.faces = [(0, 1, 2)]", r"faces have the shape \(1, 3\) of int64, expected 1 faces of 2 points"),
                             ("self.points = [(0, 0, 0, 0)] * 3", r"^self\.points has the shape \(3, 4\), expected \(3, 3\)"),
                             ("self.points = None", r"set self.points in build\(\)"),
                             ("self.sends = 'warmth'", '"warmth" is no quantity that Strake knows')):
            with self.assertRaisesRegex(strake.Error, words):
                self.alone(build=build)

    def test_a_key_that_is_missing_is_named(self):
        coupler = self.begin(script(build="key['mas']"))
        reply, _ = coupler.setup()
        self.fault(coupler, reply, "no key structure.solver.mas", 'did you mean "mass"?', code=3)

    def test_refuses_messages_that_do_not_fit(self):
        force = pb.Field(quantity="force", unit="N", components=3, n_points=3)
        for frames, word in (((b"",), "sent 0 bytes for the field force, expected 72"), ((), "no frame for the field force"),
                             ((bytes(72), b""), "more frames than its header"), ):
            coupler = self.begin(script())
            coupler.setup()
            reply, _ = coupler.ask(*frames, advance=pb.Advance(t=0, dt=1, samples=[pb.Sample(time=1, fields=[force])]))
            self.fault(coupler, reply, word, code=5)

    def test_asks_for_a_smaller_window(self):
        coupler = self.begin(script(advance="if dt > 0.5: raise strake.RetrySmallerStep(0.5, 'it buckles', 'coupling.window')"))
        coupler.setup()
        reply, arrays = coupler.advance(0, 1.0, LOAD)
        advanced = reply.advanced
        self.assertEqual((advanced.retry_smaller_dt, advanced.dt_limit, advanced.why, advanced.fix, arrays),
                         (True, 0.5, "it buckles", "coupling.window", []))
        reply, _ = coupler.advance(0, 0.5, LOAD, "REWIND")
        self.assertEqual(reply.advanced.monitor["n"], 1)

    def test_sends_several_fields_and_their_history(self):
        text = script(build="self.sends = {'displacement': (1, 2), 'velocity': 0}; self.history = True",
                      advance="self.sample(t + dt / 2, {'displacement': (7, 0), 'velocity': (8, 0)})\n"
                              "        return {'displacement': (len(self.samples), 0), 'velocity': (3, 4, 5)}")
        coupler = self.begin(text)
        reply, arrays = coupler.setup(history=True)
        self.assertTrue(reply.ready.history)
        self.assertEqual(np.frombuffer(arrays[2]).reshape(3, 3)[0].tolist(), [1, 2, 0])
        reply, arrays = coupler.advance(0, 1.0, LOAD, history=[(0.25, LOAD)])
        self.assertEqual([s.time for s in reply.advanced.history], [0.5, 1.0])
        self.assertEqual([np.frombuffer(a)[0] for a in arrays], [2, 3, 7, 8, 2, 3])

    def test_says_what_it_does_while_it_computes(self):
        coupler = self.begin(script(advance="self.working(0.5, 'assembling')"))
        coupler.setup()
        coupler.advance(0, 1.0, LOAD)
        self.assertEqual([(w.fraction, w.what) for w in coupler.working], [(0.5, "assembling")])

    def test_takes_part_under_encryption(self):
        coupler_keys, own = zmq.curve_keypair(), zmq.curve_keypair()
        with tempfile.NamedTemporaryFile("w", suffix=".key") as file:  # mode 0600
            for word, value in (("name", b"structure"), ("public", own[0]), ("secret", own[1]), ("coupler", coupler_keys[0])):
                file.write(f'{word} = "{value.decode()}"\n')
            file.flush()
            coupler = self.begin(script(), keys=coupler_keys, STRAKE_KEY=file.name)
            coupler.setup()
            coupler.stop()
            self.assertEqual(coupler.printed(), "")
            os.chmod(file.name, 0o644)
            coupler.start(script(), case=CASE, STRAKE_KEY=file.name)
            self.assertIn("can be read by others", coupler.printed())

    def test_refused_it_ends_at_once(self):
        coupler = self.begin(script())
        coupler.send(refused=pb.Refused(problem="another case", fix="the same file"))
        printed = coupler.printed()
        self.assertIn("the coupler refused this participant: another case", printed)
        self.assertEqual(coupler.process.returncode, 5)

    def test_ends_when_the_coupler_has_ended(self):
        import subprocess
        other = subprocess.Popen(["sleep", "60"])
        coupler = self.begin(script(advance="import time; time.sleep(60)"), STRAKE_COUPLER=str(other.pid))
        coupler.setup()
        coupler.send(np.zeros((3, 3)), advance=pb.Advance(t=0, dt=1, samples=[pb.Sample(time=1, fields=[
            pb.Field(quantity="force", unit="N", components=3, n_points=3)])]))
        other.kill()
        other.wait()
        self.assertIn("the coupler is gone", coupler.printed())
        self.assertEqual(coupler.process.returncode, 5)

    def test_a_wrong_command_line_is_told(self):
        coupler = ToyCoupler()
        self.addCleanup(coupler.close)
        for change, words in (({"endpoint": "over://there"}, "no endpoint"), ({"token": "xyz"}, "STRAKE_TOKEN is not hexadecimal"),
                              ({"key_file": "/nowhere.key"}, "cannot be read")):
            with self.assertRaisesRegex(strake.Error, words):
                Connection(**{**dict(endpoint=coupler.endpoint, name="structure", case_hash="", token="", solver="s", version="1"), **change})
        with self.assertRaisesRegex(strake.Error, "not that of a participant: --case"):
            Options(["--case"])
        coupler.start(script(), case=CASE, STRAKE_CONNECT="")
        self.assertIn("--connect is missing", coupler.printed())
        self.assertEqual(coupler.process.returncode, 2)


unittest.main()

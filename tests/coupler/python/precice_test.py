"""The names of preCICE's Python bindings, answered by a toy coupler: precice_test.py FOLDER_OF_strake FOLDER_OF_precice"""
import contextlib
import os
import pathlib
import sys
import tempfile
import threading
import unittest

sys.path[:0] = [sys.argv.pop(1), sys.argv.pop(1)]
import numpy as np  # noqa: E402
import precice  # noqa: E402
from precice.library import library  # noqa: E402
from precice_case import CONFIG, LOAD, MESH, PULL, READ, SQUARE, TWO_MESHES, WINDOWS, WRITE  # noqa: E402
from toy_coupler import ToyCoupler, pb  # noqa: E402

class Calls(unittest.TestCase):
    """Calls in this process; the toy coupler asks from a thread."""

    def setUp(self):
        self.coupler = ToyCoupler()
        self.addCleanup(lambda: self.end())
        os.environ.update(self.coupler.environment, STRAKE_PRECICE_NAMES="")
        self.config = pathlib.Path(tempfile.mkstemp(suffix=".xml")[1])
        self.addCleanup(self.config.unlink)
        self.config.write_text(CONFIG)
        self.thread = None

    def end(self):
        """Ends a conversation that a test left in the middle."""
        library().drop()
        self.coupler.over = True
        if self.thread:
            self.thread.join(10)
        self.coupler.close()

    def solver(self, config=None, name="Solid"):
        """A new solver, with a coupler of its own where there was one before."""
        self.end()
        self.coupler, self.thread = ToyCoupler(), None
        os.environ.update(self.coupler.environment)
        if config:
            self.config.write_text(config)
        return precice.Participant(name, str(self.config), 0, 1)

    def refused(self, call, *words):
        with self.assertRaises(precice.Error) as caught:
            call()
        for word in words:
            self.assertIn(word, str(caught.exception))

    def ready(self, windows=WINDOWS, before=None, config=None, history=()):
        """A solver after initialize(); the coupler asks for these windows of 1 s and then for the end."""
        solver = self.solver(config)
        ids = solver.set_mesh_vertices(MESH, SQUARE)
        if before:
            before(solver)
        self.answers = []

        def ask():
            with contextlib.suppress(TimeoutError):
                self.coupler.hello()
                self.answers.append(self.coupler.setup())
                for t, decision, load in windows:
                    self.answers.append(self.coupler.advance(t, 1.0, load * LOAD, decision, history=history))
                self.answers.append(self.coupler.stop())

        self.thread = threading.Thread(target=ask, daemon=True)
        self.thread.start()
        solver.initialize()
        return solver, ids

    def finish(self, solver):
        """Computes what is left of the run, at rest."""
        while solver.is_coupling_ongoing():
            solver.requires_writing_checkpoint()
            solver.requires_reading_checkpoint()
            solver.read_data(MESH, READ, range(4), 0)
            solver.write_data(MESH, WRITE, range(4), np.zeros((4, 2)))
            solver.advance(solver.get_max_time_step_size())
        solver.finalize()
        self.thread.join(10)

    def test_a_run_goes_through_all_its_windows(self):
        solver, ids = self.ready()
        seen = []
        while solver.is_coupling_ongoing():
            writes = solver.requires_writing_checkpoint()
            dt = solver.get_max_time_step_size()
            force = solver.read_data(MESH, READ, ids, dt)
            solver.write_data(MESH, WRITE, ids, 2 * force)
            solver.advance(dt)
            seen.append((writes, dt, force[0].tolist(), solver.requires_reading_checkpoint(), solver.is_time_window_complete()))
        self.assertEqual(seen, [(True, 1.0, [0, 1], True, False), (False, 1.0, [0, 2], False, True), (True, 1.0, [0, 5], False, True)])
        self.assertEqual(solver.get_max_time_step_size(), 0)
        solver.finalize()
        self.thread.join(10)
        kinds = [reply.WhichOneof("what") for reply, _ in self.answers]
        self.assertEqual(kinds, ["ready", "advanced", "advanced", "advanced", "done"])
        ready = self.answers[0][0].ready
        self.assertEqual([(f.quantity, f.unit, f.components, f.conservative) for f in ready.initial], [("displacement", "m", 3, False)])
        self.assertEqual(np.frombuffer(self.answers[3][1][0]).reshape(4, 3)[1].tolist(), [0, 10, 0])

    def test_reads_along_a_line_between_the_ends_of_a_window(self):
        solver, ids = self.ready()
        one = lambda t: solver.read_data(MESH, READ, ids[:1], t)[0, 1]  # noqa: E731
        self.assertEqual((one(0), one(0.5), one(1)), (0, 0.5, 1))
        self.refused(lambda: solver.advance(0.25), "advance(): checkpoint: the solver has not asked", "requires_writing_checkpoint()")
        self.assertTrue(solver.requires_writing_checkpoint())
        solver.advance(0.25)
        self.assertFalse(solver.is_time_window_complete())
        self.assertFalse(solver.requires_writing_checkpoint())
        self.assertEqual((solver.get_max_time_step_size(), one(0), one(0.75)), (0.75, 0.25, 1))
        self.refused(lambda: one(0.76), "read_data", "reads at 0.76 s after now", "0.75 s are left")

    def test_a_window_of_which_the_start_alone_was_read_is_told(self):
        solver, _ = self.ready()
        self.finish(solver)
        self.assertEqual([reply.advanced.monitor.get("precice.start_read") for reply, _ in self.answers[1:-1]], [0, 0, 0])
        solver, ids = self.ready()
        solver.read_data(MESH, READ, ids, 0.5)
        self.finish(solver)
        self.assertEqual([reply.advanced.monitor.get("precice.start_read") for reply, _ in self.answers[1:-1]], [None, 0, 0])

    def test_an_explicit_scheme_asks_for_no_checkpoint(self):
        solver, _ = self.ready(windows=[(0, "NOTHING", 1.0), (1, "COMMIT", 1.0)], config=CONFIG.replace("serial-implicit", "serial-explicit"))
        self.assertFalse(solver.requires_writing_checkpoint())
        self.finish(solver)
        solver, ids = self.ready(config=CONFIG.replace("serial-implicit", "serial-explicit"))
        solver.write_data(MESH, WRITE, ids, SQUARE)
        self.refused(lambda: solver.advance(1), "explicit scheme", "max_iterations = 1")

    def test_what_was_written_is_zero_again_after_a_step(self):
        solver, ids = self.ready(windows=[(0, "NOTHING", 1.0)], config=PULL)
        solver.requires_writing_checkpoint()
        solver.write_data(MESH, "Pull", ids, SQUARE)
        solver.advance(0.5)
        self.refused(lambda: solver.advance(0.5), 'data "Pull" of mesh "Solid-Mesh": was not written')
        solver.write_data(MESH, "Pull", ids[:1], [(3, 4)])  # a force may be written at some vertices alone
        solver.advance(0.5)
        solver.finalize()
        self.thread.join(10)
        self.assertEqual(np.frombuffer(self.answers[1][1][0]).reshape(4, 2).tolist(), [[3, 4]] + [[0, 0]] * 3)
        self.assertEqual([w.what for w in self.coupler.working], ["time steps inside the window"])

    def test_sections_are_seconds(self):
        solver, ids = self.ready(windows=[(0, "NOTHING", 1.0)])
        solver.start_profiling_section("solve")
        solver.stop_last_profiling_section()
        self.refused(solver.stop_last_profiling_section, "stop_last_profiling_section(): sections: none is open")
        self.finish(solver)
        self.assertGreater(self.answers[1][0].advanced.monitor["seconds.solve"], 0)

    def test_sub_steps_end_with_the_window(self):
        solver, ids = self.ready(windows=[(0, "NOTHING", 1.0)])
        solver.requires_writing_checkpoint()
        for k in range(3):
            solver.write_data(MESH, WRITE, ids, [(0, k)] * 4)
            solver.advance(1 / 3)
        self.assertTrue(solver.is_time_window_complete())
        self.assertFalse(solver.is_coupling_ongoing())
        solver.finalize()
        self.thread.join(10)
        self.assertEqual(np.frombuffer(self.answers[1][1][0]).reshape(4, 3)[0].tolist(), [0, 2, 0])

    def test_samples_inside_a_window_are_read_where_the_configuration_asks(self):
        text = CONFIG.replace('to="Solid"/>\n  </coupling', 'to="Solid" substeps="true"/>\n  </coupling')
        solver, ids = self.ready(windows=[(0, "NOTHING", 4.0)], config=text, history=[(0.5, LOAD)])
        self.assertEqual([solver.read_data(MESH, READ, ids[:1], t)[0, 1] for t in (0.25, 0.5, 0.75, 1)], [0.5, 1, 2.5, 4])
        self.finish(solver)
        self.assertTrue(self.answers[0][0].ready.history)

    def test_initial_data_are_sent_where_the_configuration_asks(self):
        text = CONFIG.replace('from="Solid" to="Fluid"/>', 'from="Solid" to="Fluid" initialize="true"/>')
        solver = self.solver(text)
        solver.set_mesh_vertices(MESH, SQUARE)
        self.refused(solver.initialize, "initialize", "requires_initial_data")

        def write(solver):
            self.assertTrue(solver.requires_initial_data())
            solver.write_data(MESH, WRITE, [2], [(7, 8)])

        solver, _ = self.ready(config=text, before=write)
        self.finish(solver)
        self.assertEqual(np.frombuffer(self.answers[0][1][1]).reshape(4, 3).tolist(), [[0, 0, 0]] * 2 + [[7, 8, 0], [0, 0, 0]])

    def test_faces_are_what_the_solver_connects(self):
        def connect(solver):
            self.assertTrue(solver.requires_mesh_connectivity_for(MESH))
            solver.set_mesh_edges(MESH, [(0, 1), (1, 2), (2, 3)])
            solver.set_mesh_edge(MESH, 3, 0)

        solver, _ = self.ready(before=connect)
        self.finish(solver)
        reply, arrays = self.answers[0]
        self.assertEqual(reply.ready.mesh.n_faces, 4)
        self.assertEqual(np.frombuffer(arrays[1], "<i4").reshape(4, 2).tolist(), [[0, 1], [1, 2], [2, 3], [3, 0]])

    def with_two_meshes(self, points=((2, 0), (3, 0), (2.5, 1)), config=None, load=None):
        """The displacement is written on a mesh of its own of three points; a load at all seven points."""
        solver = self.solver(config or TWO_MESHES)
        ids, own = solver.set_mesh_vertices(MESH, SQUARE), solver.set_mesh_vertices("Solid-Tip", points)
        solver.set_mesh_edges("Solid-Tip", [(0, 1), (1, 2)] if len(points) else [])
        self.answers = []

        def ask():
            with contextlib.suppress(TimeoutError):
                self.coupler.hello()
                self.answers.append(self.coupler.setup())
                self.answers.append(self.coupler.advance(0, 1.0, np.arange(21.0).reshape(7, 3) if load is None else load, "NOTHING"))
                self.answers.append(self.coupler.stop())

        self.thread = threading.Thread(target=ask, daemon=True)
        self.thread.start()
        return solver, ids, own

    def test_two_meshes_are_one_for_the_coupler(self):
        solver, ids, own = self.with_two_meshes()
        solver.initialize()
        self.assertEqual((list(own), solver.get_mesh_vertex_size("Solid-Tip")), ([0, 1, 2], 3))
        self.assertEqual([array.tolist() for array in solver.get_mesh_vertex_ids_and_coordinates("Solid-Tip")], [[0, 1, 2], [[2, 0], [3, 0], [2.5, 1]]])
        self.assertEqual(solver.read_data(MESH, READ, ids, 1.0).tolist(), [[0, 1], [3, 4], [6, 7], [9, 10]])
        solver.requires_writing_checkpoint()
        solver.write_data("Solid-Tip", WRITE, own, [(1, 2), (3, 4), (5, 6)])
        self.refused(lambda: solver.write_data(MESH, WRITE, ids, SQUARE), "write_data()", 'data "Displacement" of mesh "Solid-Mesh": is not written')
        self.refused(lambda: solver.read_data("Solid-Tip", READ, own, 1.0), "read_data()", 'data "Force"', 'mesh "Solid-Tip"')
        self.refused(lambda: solver.write_data("Solid-Tip", WRITE, ids, SQUARE), "write_data()", 'mesh "Solid-Tip": has no vertex 3', "from 0 to 2")
        solver.advance(1.0)
        solver.finalize()
        self.thread.join(10)
        ready, arrays = self.answers[0][0].ready, self.answers[0][1]
        self.assertEqual((ready.mesh.n_points, [(m.name, m.first_point, m.first_face) for m in ready.mesh.meshes]), (7, [(MESH, 0, 0), ("Solid-Tip", 4, 0)]))
        self.assertEqual([(f.quantity, f.mesh) for f in (*ready.sent_on, *ready.taken_on)], [("displacement", "Solid-Tip"), ("force", MESH)])
        self.assertEqual(np.frombuffer(arrays[1], "<i4").tolist(), [4, 5, 5, 6])
        sent = np.frombuffer(self.answers[1][1][0]).reshape(7, 3)
        self.assertEqual(sent.tolist(), [[0, 0, 0]] * 4 + [[1, 2, 0], [3, 4, 0], [5, 6, 0]])

    def test_a_mesh_of_two_that_is_wrong_is_named(self):
        solver, _, _ = self.with_two_meshes(points=())
        self.refused(solver.initialize, "initialize()", 'mesh "Solid-Tip": has no vertices')
        self.refused(lambda: self.solver(TWO_MESHES.replace("<write-data", '<write-data name="Displacement" mesh="Solid-Mesh"/> <write-data')),
                     'writes data "Displacement" of mesh "Solid-Mesh" and data "Displacement" of mesh "Solid-Tip": both are displacement')
        solver, _, _ = self.with_two_meshes(load=LOAD)
        self.refused(solver.initialize, "3 components at 4 points; expected 3 at 7")
        self.refused(lambda: self.solver(TWO_MESHES.replace('"Solid-Tip" dimensions="2"', '"Solid-Tip" dimensions="3"')),
                     'provides "Solid-Mesh" in 2 dimensions and "Solid-Tip" in 3')

    def test_data_that_are_not_written_or_not_read_are_named(self):
        solver, ids = self.ready([(0, "NOTHING", 1.0), (1, "COMMIT", 1.0)])
        name = 'advance(): data "Displacement" of mesh "Solid-Mesh": was '
        solver.requires_writing_checkpoint()
        self.refused(lambda: solver.advance(1), name + "not written before this advance()", "write_data()", "<write-data>")
        solver.write_data(MESH, WRITE, ids[[0, 2, 3]], SQUARE[:3])
        self.refused(lambda: solver.advance(1), name + "written before this advance() at 3 of 4 vertices; vertex 1 has no value", "write_data()")
        solver.write_data(MESH, WRITE, ids[1:2], SQUARE[:1])
        solver.advance(0.5)  # inside the window nothing is sent
        self.refused(lambda: solver.advance(0.5), name + "not written")
        solver.write_data(MESH, WRITE, ids, SQUARE)
        solver.advance(0.5)
        solver.requires_writing_checkpoint()
        solver.requires_reading_checkpoint()
        solver.write_data(MESH, WRITE, ids, SQUARE)
        self.refused(lambda: solver.advance(1), 'advance(): data "Force" of mesh "Solid-Mesh": was not read so far', "read_data()", "<read-data>")
        solver.read_data(MESH, READ, ids, 1.0)
        solver.advance(1)
        solver.finalize()
        self.thread.join(10)

    def test_calls_in_a_wrong_order_are_refused_by_name(self):
        solver = self.solver()
        for name in ("is_coupling_ongoing", "is_time_window_complete", "get_max_time_step_size", "requires_writing_checkpoint",
                     "requires_reading_checkpoint"):
            self.refused(getattr(solver, name), f"{name}(): order of calls: initialize() was not called yet")
        self.refused(lambda: solver.advance(1), "advance(): order of calls: initialize() was not called yet")
        self.refused(lambda: solver.read_data(MESH, READ, [0], 0), "read_data(): order of calls: initialize() was not called yet")
        self.refused(solver.initialize, "initialize(): ", "Solid-Mesh", "no vertices")
        solver, ids = self.ready()
        self.refused(solver.initialize, "initialize(): order of calls: initialize() was called before")
        self.refused(lambda: solver.set_mesh_vertex(MESH, (0, 0)), "set_mesh_vertex(): order of calls: initialize() was called before")
        self.refused(solver.requires_initial_data, "requires_initial_data(): order of calls: initialize() was called before")
        for step, word in ((0, "greater than 0"), (-1, "greater than 0"), (float("inf"), "finite"), (float("nan"), "finite"), (1.01, "1 s are left of the window")):
            self.refused(lambda: solver.advance(step), "advance(): time step: is", word)
        solver.requires_writing_checkpoint()
        solver.write_data(MESH, WRITE, ids, SQUARE)
        solver.advance(1)
        self.refused(lambda: solver.advance(1), "advance(): checkpoint: the solver has not asked", "requires_reading_checkpoint()")
        self.finish(solver)
        self.refused(solver.finalize, "finalize(): was called after finalize()")
        self.refused(solver.is_coupling_ongoing, "is_coupling_ongoing(): was called after finalize()")
        self.refused(lambda: solver.write_data(MESH, WRITE, ids, SQUARE), "write_data(): was called after finalize()")

    def test_names_and_shapes_that_are_wrong_are_refused(self):
        self.refused(lambda: self.solver(name="Soild"), 'no participant "Soild"', 'did you mean "Solid"?')
        self.refused(lambda: precice.Participant("Solid", str(self.config), 1, 2), "runs as 2 processes")
        solver, ids = self.ready()
        self.refused(lambda: solver.get_mesh_dimensions("Sold-Mesh"), "get_mesh_dimensions()", 'did you mean "Solid-Mesh"?')
        self.refused(lambda: solver.get_mesh_vertex_size("Fluid-Mesh"), "get_mesh_vertex_size()", "is the partner's")
        self.refused(lambda: solver.read_data(MESH, WRITE, ids, 0), "read_data()", 'data "Displacement" of mesh "Solid-Mesh": is not read')
        self.refused(lambda: solver.write_data(MESH, READ, ids, SQUARE), "write_data()", 'data "Force" of mesh "Solid-Mesh": is not written')
        self.refused(lambda: solver.write_data(MESH, WRITE, ids, [1, 2, 3]), "expected 4 × 2")
        self.refused(lambda: solver.write_data(MESH, WRITE, [4], [(1, 2)]), "has no vertex 4", "from 0 to 3")
        self.refused(lambda: solver.write_data(MESH, WRITE, [0], [(1, float("nan"))]), "write_data", "not finite")
        self.assertEqual((solver.get_mesh_dimensions(MESH), solver.get_data_dimensions(MESH, READ), solver.get_mesh_vertex_size(MESH)), (2, 2, 4))
        self.finish(solver)

    def test_ids_that_are_no_faces_are_refused(self):
        solver = self.solver()
        ids = solver.set_mesh_vertices(MESH, SQUARE)
        self.refused(lambda: solver.set_mesh_edges(MESH, ids[:3]), "set_mesh_edges(): ids of the shape (3,), expected 2 in a row")
        self.refused(lambda: solver.set_mesh_edges(MESH, [(0.0, 1.0)]), "set_mesh_edges(): ids are whole numbers, not float64")
        self.refused(lambda: solver.set_mesh_vertices(MESH, [(0, 0, 0)]), "set_mesh_vertices(): the positions have the shape (1, 3), expected 1 × 2")
        self.refused(lambda: solver.set_mesh_vertices(MESH, [("a", "b")]), "set_mesh_vertices(): the positions are no numbers")

    def test_what_strake_does_not_have_is_refused_by_name(self):
        solver = self.solver()
        for name, arguments in (("reset_mesh", 1), ("set_mesh_access_region", 2),                                 ("write_and_map_data", 4), ("map_and_read_data", 4), ("write_gradient_data", 4)):
            self.refused(lambda: getattr(solver, name)(*[MESH] * arguments), f"{name}(): not supported: ")
        self.assertFalse(solver.requires_gradient_data_for(MESH, READ))
        self.assertTrue(precice.get_version_information().startswith(b"3.4.1"))

    def test_data_that_the_partner_does_not_send_are_told(self):
        os.environ["STRAKE_PRECICE_NAMES"] = "Force=traction; Displacement=displacement"
        self.refused(lambda: self.ready()[0], 'data "Force" of mesh "Solid-Mesh": is not sent by the partner (looked for traction); it sends force', "STRAKE_PRECICE_NAMES")

    def test_outside_of_a_run_the_module_says_whose_it_is(self):
        os.environ["STRAKE_CONNECT"] = ""
        self.refused(lambda: precice.Participant("Solid", str(self.config), 0, 1), "STRAKE_CONNECT is not set", "strake run CASE", "PYTHONPATH")


class Faults(unittest.TestCase):
    """A solver as a program: what it throws ends the run at once, and is named."""

    SOLVER = """import precice, sys
solver = precice.Participant("Solid", sys.argv[-1], 0, 1)
ids = solver.set_mesh_vertices("Solid-Mesh", [(0, 0), (1, 0), (1, 1), (0, 1)])
solver.initialize()
LINE
solver.advance(1)
solver.finalize()
"""

    def test_an_exception_before_initialize_is_named_too(self):
        fault, _ = self.fault_of("", first="1 / 0")
        self.assertEqual(fault, 'structure, preCICE participant "Solid": solver.py:3, in <module>: ZeroDivisionError: division by zero (4)')

    def fault_of(self, line, first=""):
        coupler = ToyCoupler()
        self.addCleanup(coupler.close)
        config = coupler.folder / "precice-config.xml"
        config.write_text(CONFIG)
        coupler.start(self.SOLVER.replace("LINE", line).replace("ids = ", f"{first}\nids = " if first else "ids = "), str(config))
        coupler.hello()
        reply, _ = coupler.setup()
        if not first:
            self.assertEqual(reply.WhichOneof("what"), "ready")
            reply, _ = coupler.advance(0, 1.0, LOAD)
        printed = coupler.printed()
        self.assertEqual(reply.WhichOneof("what"), "fault", printed)
        self.assertNotEqual(coupler.process.returncode, 0)
        return f"{reply.fault.where}: {reply.fault.problem} ({reply.fault.exit_code})", printed

    def test_an_exception_is_named_with_its_line(self):
        fault, printed = self.fault_of("1 / 0")
        self.assertEqual(fault, 'structure, preCICE participant "Solid": solver.py:5, in <module>: ZeroDivisionError: division by zero (4)')
        self.assertIn("Traceback", printed)

    def test_a_wrong_call_is_named(self):
        self.assertIn("advance(), time step: is -1 s (4)", self.fault_of("solver.advance(-1)")[0])

    def test_leaving_early_is_named(self):
        self.assertIn('preCICE participant "Solid": ended before the run did, without finalize() (4)', self.fault_of("sys.exit(3)")[0])
        self.assertIn('"Solid": called finalize() before the end of the run (4)', self.fault_of("solver.finalize(); sys.exit(1)")[0])


unittest.main()

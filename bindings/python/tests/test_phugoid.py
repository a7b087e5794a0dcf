"""The package as a user meets it. Run by scripts/check-python.sh, which installs the wheel first."""

import copy
import datetime
import pickle
import subprocess
import sys
import threading
from pathlib import Path

import matplotlib
import numpy as np
import pandas
import phugoid
import polars
import pytest
from conftest import content


@pytest.fixture(scope="module")
def flight():
    return phugoid.simulate("f16-calm", seed=3)


@pytest.fixture(scope="module")
def model():
    return phugoid.Model.named("f16-model")


@pytest.fixture(scope="module")
def result(flight, model):
    measured, _, truth = flight
    return phugoid.estimate(measured, model, truth=truth)


def test_the_truth_lies_within_four_sigma(flight, result):
    # Four parameters of one seed: beyond four sigma by chance once in 4000 seeds.
    for parameter in result.to_dict()["parameters"]:
        assert abs(parameter["value"] - flight[2][parameter["name"]]) < 4 * parameter["corrected_std_error"]
    assert result["dCm_q"] == (result.values[result.names.index("dCm_q")], result.std_errors[result.names.index("dCm_q")])
    with pytest.raises(KeyError, match="dCm_alpha"):
        result["Cm_alpha"]
    # The pitch damping of the book is about -7 here, and the increment -2.
    total, std_error = result.totals["Cm_q"]
    assert total < result["dCm_q"][0] - 3 and std_error == result["dCm_q"][1]
    # Nothing is declared of an increment.
    assert (result.systematic_std_errors == 0).all()


def test_the_likelihood_is_chosen_by_its_word(flight, model):
    by = {
        word: phugoid.estimate(flight[0], model, method="output-error", structure="never", likelihood=word)
        for word in ("robust", "gaussian")
    }
    # Of Gaussian noise one value in 370 is beyond three sigmas: nearly the same, and not quite.
    difference = np.abs(by["robust"].values - by["gaussian"].values) / by["robust"].std_errors
    assert 0 < difference.max() < 0.5
    with pytest.raises(phugoid.PhugoidError, match="'robust' or 'gaussian'"):
        phugoid.estimate(flight[0], model, likelihood="student")


def test_the_flow_angles_are_chosen_by_their_word(flight, model):
    by = {
        word: phugoid.estimate(flight[0], model, method="output-error", structure="never", flow_angles=word)
        for word in ("auto", "simulated", "measured")
    }
    # In calm air they are simulated, and the measured ones are another estimate of the same.
    assert (by["auto"].values == by["simulated"].values).all()
    difference = np.abs(by["measured"].values - by["simulated"].values)
    assert 0 < difference.max() and (difference < 4 * (by["measured"].std_errors + by["simulated"].std_errors)).all()
    with pytest.raises(phugoid.PhugoidError, match="'auto', 'simulated' or 'measured'"):
        phugoid.estimate(flight[0], model, flow_angles="vane")


def test_sample_by_sample_gives_the_same_bits(flight, model, result):
    measured = flight[0]
    session = phugoid.Session(model)
    samples = np.column_stack([measured[name] for name in session.channels])
    # A sample that is not used is told from one that is, and no estimate is there yet.
    first = session.update(measured.time[0], samples[0])
    assert not first and first.kind == "waiting" and "noise" in first.reason and session.message == first.reason
    again = session.update(measured.time[0], samples[0])
    assert not again and again.kind == "refused" and "does not come after" in again.reason and "refused" in repr(again)
    assert session.update(np.nan, samples[1]).kind == "refused"
    short = session.update(measured.time[1], samples[1][:-1].copy())
    assert short.kind == "refused" and "expected one for each of" in short.reason
    for time_s, sample in zip(measured.time[1:], samples[1:]):
        last = session.update(time_s, sample)
    assert last and last.kind == "estimated" and last.reason is None and session.message is None
    assert [value.hex() for value in session.values] == [result[name][0].hex() for name in session.parameters]
    snapshot = session.snapshot()
    assert snapshot["parameters"][0]["readiness"]["verdict"] == "ready"
    assert [p["name"] for p in session.layout()["parameters"]] == session.parameters
    assert session.take_events() == []


def test_a_session_of_all_axes_runs_on_a_small_stack(model):
    measured, _, _ = phugoid.simulate("f16-six")
    six = phugoid.Model.named("f16-six")
    reached = []

    def fly():
        session = phugoid.Session(six)
        samples = np.column_stack([measured[name] for name in session.channels])
        for time_s, sample in zip(measured.time[:400], samples):
            session.update(time_s, sample)
        reached.append(session.values)

    threading.stack_size(512 * 1024)
    thread = threading.Thread(target=fly)
    thread.start()
    thread.join()
    threading.stack_size(0)
    assert len(reached[0]) == len(six.parameters)


@pytest.mark.parametrize("to_frame", ["to_pandas", "to_polars"])
def test_frames_go_in_and_out(flight, model, result, to_frame):
    frame = getattr(flight[0], to_frame)()
    again = phugoid.Record.from_frame(frame)
    assert np.array_equal(phugoid.estimate(again, model).values, result.values)
    table = getattr(result, to_frame)()
    assert isinstance(table, (pandas.DataFrame, polars.DataFrame)) and len(table) == len(result.names)


def test_a_file_and_mapped_columns(tmp_path, flight):
    measured = flight[0]
    path = tmp_path / "flight.csv"
    measured.write_csv(path)
    again = phugoid.Record.open(path)
    assert again.channels == measured.channels and np.array_equal(again["alpha"], measured["alpha"])
    degrees = {"t_s": measured.time, "ELEV": np.degrees(measured["elevator"])}
    mapped = phugoid.Record.from_columns(degrees, columns={"elevator": {"header": "ELEV", "unit": "deg", "scale": -1}})
    np.testing.assert_allclose(mapped["elevator"], -measured["elevator"], rtol=1e-15)
    assert mapped.units["elevator"] == "rad"
    assert len(mapped.between(1, 2)) == 101


def test_errors_have_the_texts_of_the_command_line(tmp_path, flight, model):
    with pytest.raises(phugoid.PhugoidError, match="built-in model `hfb320`"):
        phugoid.Model.named("hfb230")
    with pytest.raises(phugoid.PhugoidError, match=r"mine:1:\d+"):
        phugoid.Model.parse("nmae = 'x'", name="mine")
    with pytest.raises(phugoid.PhugoidError, match="channel `elevator` is missing"):
        phugoid.estimate(phugoid.Record.from_columns({"time_s": np.arange(50.0), "alpha_rad": np.zeros(50)}), model)
    with pytest.raises(phugoid.PhugoidError, match="smpe"):
        phugoid.estimate(flight[0], model, method="smqe")
    with pytest.raises(phugoid.PhugoidError, match="whole"):
        phugoid.Session(model, method="output-error")
    with pytest.raises(phugoid.PhugoidError, match="cannot be read|No such file"):
        phugoid.Record.open(tmp_path / "none.csv")
    flight[0].write_csv(tmp_path / "flight.csv")
    with pytest.raises(phugoid.PhugoidError, match="the budget is 5 kB"):
        phugoid.Record.open(tmp_path / "flight.csv", max_memory="5kB")
    with pytest.raises(phugoid.PhugoidError, match="no amount of memory"):
        phugoid.Record.open(tmp_path / "flight.csv", max_memory="5")
    with pytest.raises(phugoid.PhugoidError, match="shape"):
        phugoid.Record.from_columns({"time_s": np.zeros((3, 2))})
    with pytest.raises(KeyError, match="alpha"):
        flight[0]["alhpa"]


def test_an_error_in_the_progress_function_is_not_lost(flight, model):
    def fail(fraction):
        raise RuntimeError("stop")

    with pytest.raises(RuntimeError, match="stop"):
        phugoid.estimate(flight[0], model, progress=fail)
    seen = []
    phugoid.estimate(flight[0], model, progress=seen.append)
    assert seen[-1] == 1.0 and seen == sorted(seen)


def test_the_gil_is_released(flight, model):
    turns = 0
    finished = threading.Event()

    def work():
        phugoid.compare(["calm"], ["smpe"], seeds=4)
        finished.set()

    thread = threading.Thread(target=work)
    thread.start()
    # Were the GIL held, this loop would not turn before the work is done.
    while not finished.is_set():
        turns += 1
    thread.join()
    assert turns > 100


def test_two_threads_estimate_at_once(flight, model):
    """Each waits inside its estimation until the other one is inside its own: with a lock of ours, neither would end."""
    meeting = threading.Barrier(2)
    met = []

    def work():
        first = []

        def progress(fraction):
            if not first:
                first.append(fraction)
                meeting.wait(timeout=60)
                met.append(threading.get_ident())

        phugoid.estimate(flight[0], model, progress=progress)

    threads = [threading.Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(set(met)) == 2


def turns_during(call):
    """How often this thread turns a loop while another one makes five calls."""
    turns = 0
    finished = threading.Event()

    def work():
        for _ in range(5):
            call()
        finished.set()

    interval = sys.getswitchinterval()
    # Who has the lock of the interpreter keeps it: only a call that gives it away itself lets this thread turn.
    sys.setswitchinterval(60)
    try:
        thread = threading.Thread(target=work)
        thread.start()
        while not finished.is_set():
            turns += 1
            if turns % 1000 == 0:
                # Gives it back, as a thread that reads a file does.
                finished.wait(1e-5)
        thread.join()
    finally:
        sys.setswitchinterval(interval)
    return turns


@pytest.mark.parametrize(
    "call",
    [
        lambda record: phugoid.compatibility(record, flat_earth=True),
        lambda record: phugoid.inspect(record, phugoid.Model.named("f16-model")),
        lambda record: phugoid.simulate("f16-calm"),
        lambda record: phugoid.design("multisine"),
        lambda record: phugoid.estimate(record, phugoid.Model.named("f16-model"), structure="never"),
        lambda record: pickle.dumps(record),
    ],
    ids=["compatibility", "inspect", "simulate", "design", "estimate", "pickle"],
)
def test_another_thread_works_while_a_call_lasts(flight, call):
    # One thousand turns at least for each call that has given the lock away.
    assert turns_during(lambda: call(flight[0])) > 2000


def test_a_call_that_keeps_the_lock_would_be_noticed():
    assert turns_during(lambda: sum(range(1_000_000))) <= 2000


def test_a_session_is_used_by_several_threads(flight, model):
    session = phugoid.Session(model)
    samples = np.column_stack([flight[0][name] for name in session.channels])
    failures = []

    def read():
        try:
            while not finished.is_set():
                session.values, session.message, repr(session)
        except Exception as error:  # whatever it is, the test fails
            failures.append(error)

    finished = threading.Event()
    thread = threading.Thread(target=read)
    thread.start()
    for time_s, sample in zip(flight[0].time[:600], samples):
        session.update(time_s, sample)
    finished.set()
    thread.join()
    assert failures == [] and session.values is not None


def test_what_is_pickled_and_copied_is_the_same(flight, model, result):
    for again in (pickle.loads(pickle.dumps(flight[0])), copy.deepcopy(flight[0])):
        assert again.channels == flight[0].channels and np.array_equal(again.time, flight[0].time)
        assert all(np.array_equal(again[name], flight[0][name], equal_nan=True) for name in again.channels)
        assert again.quality == flight[0].quality and again.source == flight[0].source and again.units == flight[0].units
    deleted = flight[0].delete(1.0, 1.1, reason="bird", channels="alpha")
    assert pickle.loads(pickle.dumps(deleted)).deletions == deleted.deletions
    assert np.isnan(copy.copy(deleted)["alpha"]).sum() == 11
    for again in (pickle.loads(pickle.dumps(model)), copy.deepcopy(model)):
        assert again.source == model.source and again.toml == model.toml
        assert np.array_equal(phugoid.estimate(flight[0], again).values, result.values)
    for again in (pickle.loads(pickle.dumps(result)), copy.deepcopy(result)):
        assert again.to_dict() == result.to_dict() and repr(again) == repr(result)
        assert np.array_equal(again.values, result.values) and np.array_equal(again.covariance, result.covariance)
        assert np.array_equal(again.history["dCm_q"], result.history["dCm_q"], equal_nan=True)
    # A batch method leaves NaN where nothing is measured.
    batch = phugoid.estimate(flight[0], model, method="equation-error", structure="never")
    assert repr(pickle.loads(pickle.dumps(batch))) == repr(batch)
    with pytest.raises(phugoid.PhugoidError, match="no record"):
        phugoid._phugoid.Record.from_bytes(b"rubbish")


def test_a_pickle_is_read_in_another_process(tmp_path, result):
    (tmp_path / "result.pickle").write_bytes(pickle.dumps(result))
    code = "import pickle, sys; print(pickle.load(open(sys.argv[1], 'rb')).parameter('dCm_q').value.hex())"
    told = subprocess.run(
        [sys.executable, "-c", code, tmp_path / "result.pickle"], check=True, capture_output=True, text=True
    )
    assert told.stdout.strip() == result["dCm_q"][0].hex()


def test_the_covariance_has_names(result):
    frame = result.covariance_to_pandas()
    assert list(frame.index) == list(frame.columns) == result.names
    np.testing.assert_allclose(np.sqrt(np.diag(frame)), result.std_errors, rtol=1e-12)
    between = frame.loc["dCm_alpha", "dCm_q"] / np.prod([result[name][1] for name in ("dCm_alpha", "dCm_q")])
    place = [result.names.index(name) for name in ("dCm_alpha", "dCm_q")]
    assert between == pytest.approx(result.correlation[place[0], place[1]])
    assert np.array_equal(result.covariance, result.covariance.T) and (np.linalg.eigvalsh(result.covariance) > 0).all()


BERLIN = pandas.date_range("2024-05-01 14:34:56.5", periods=50, freq="20ms", tz="Europe/Berlin")


def test_a_frame_with_dates_is_a_record_with_a_start(tmp_path):
    columns = {"alpha_deg": np.linspace(0, 1, 50), "note": ["x"] * 50}
    record = phugoid.Record.from_frame(pandas.DataFrame(columns, index=BERLIN))
    assert record.channels == ["alpha"]
    np.testing.assert_allclose(record.time, 0.02 * np.arange(50), atol=1e-12)
    assert record.start == datetime.datetime(2024, 5, 1, 12, 34, 56, 500_000, tzinfo=datetime.timezone.utc)
    # Back again: the same instants, in UTC.
    frame = record.to_pandas(index="time")
    assert frame.index.tz is not None and (frame.index == BERLIN).all() and list(frame.columns) == ["alpha_rad"]
    assert phugoid.Record.from_frame(frame).start == record.start
    # Without a zone, and with durations.
    naive = phugoid.Record.from_frame(pandas.DataFrame(columns, index=BERLIN.tz_localize(None)))
    assert naive.start == datetime.datetime(2024, 5, 1, 14, 34, 56, 500_000)
    assert naive.to_pandas(index="datetime").index.tz is None
    durations = phugoid.Record.from_frame(pandas.DataFrame(columns, index=BERLIN - BERLIN[0]))
    assert durations.start is None and np.array_equal(durations.time, record.time)
    assert isinstance(durations.to_pandas(index="time").index, pandas.TimedeltaIndex)
    assert "time_s" in durations.to_pandas().columns
    with pytest.raises(phugoid.PhugoidError, match="with_start"):
        durations.to_pandas(index="datetime")
    with pytest.raises(phugoid.PhugoidError, match="'time', 'datetime' or 'timedelta'"):
        durations.to_pandas(index="date")
    when = datetime.datetime(2025, 1, 2, 3, 4, 5, tzinfo=datetime.timezone(datetime.timedelta(hours=1)))
    assert durations.with_start(when).start == when and durations.with_start(None).start is None
    with pytest.raises(phugoid.PhugoidError, match="datetime"):
        durations.with_start("2025-01-02")
    # Index and column at once: nobody can know which is meant.
    both = pandas.DataFrame({"time_s": np.arange(50.0), **columns}, index=BERLIN)
    with pytest.raises(phugoid.PhugoidError, match="reset_index"):
        phugoid.Record.from_frame(both)
    # Numbers are times where the index is called so, in the unit that it states.
    seconds = pandas.Index(0.02 * np.arange(50.0), name="time_s")
    assert phugoid.Record.from_frame(pandas.DataFrame(columns, index=seconds)).time[-1] == 0.98
    milliseconds = pandas.Index(20 * np.arange(50), name="time_ms")
    assert abs(phugoid.Record.from_frame(pandas.DataFrame(columns, index=milliseconds)).time[-1] - 0.98) < 1e-12
    with pytest.raises(phugoid.PhugoidError, match="reset_index"):
        phugoid.Record.from_frame(pandas.DataFrame({"t": np.arange(50.0), **columns}, index=seconds))
    # A file with dates has a start too, and a part of it keeps the same zero.
    (tmp_path / "dated.csv").write_text("time,alpha_deg\n2024-05-01T14:34:56+02:00,1\n2024-05-01T14:34:57+02:00,2\n")
    dated = phugoid.Record.open(tmp_path / "dated.csv")
    assert dated.start == datetime.datetime(2024, 5, 1, 12, 34, 56, tzinfo=datetime.timezone.utc)
    assert dated.between(1.0, 1.0).to_pandas(index="time").index[0] == pandas.Timestamp("2024-05-01T12:34:57Z")


def test_a_column_of_dates_is_the_time():
    for frame in (
        pandas.DataFrame({"when": BERLIN, "alpha_deg": np.arange(50.0)}),
        polars.DataFrame({"when": polars.Series(BERLIN.to_list()), "alpha_deg": np.arange(50.0)}),
    ):
        record = phugoid.Record.from_frame(frame)
        assert record.start == BERLIN[0] and record.time[-1] == pytest.approx(0.98, abs=1e-12)
    two = pandas.DataFrame({"when": BERLIN, "logged": BERLIN, "alpha_deg": np.arange(50.0)})
    with pytest.raises(phugoid.PhugoidError, match="'when', 'logged'"):
        phugoid.Record.from_frame(two)


def test_histories_have_the_times_of_the_record(flight, model):
    start = datetime.datetime(2024, 5, 1, 12, 0, tzinfo=datetime.timezone.utc)
    result = phugoid.estimate(flight[0].with_start(start), model)
    frame = result.history.to_pandas(index="time")
    assert isinstance(frame.index, pandas.DatetimeIndex) and frame.index[0] == start
    assert (frame.index[-1] - frame.index[0]).total_seconds() == pytest.approx(20.0)
    assert frame["dCm_q"].iloc[-1] == result["dCm_q"][0]
    table = result.to_pandas()
    assert table.loc["dCm_q", "unit"] == "per rad" and table["truth"].isna().all()


def test_a_result_is_drawn(tmp_path, result):
    matplotlib.use("Agg")
    figure = result.plot()
    shown = [axes for axes in figure.axes if axes.get_visible()]
    assert [axes.get_ylabel() for axes in shown] == [f"{name} [per rad]" for name in result.names]
    assert shown[-1].get_xlabel() == "time [s]" and "±" in shown[0].get_title(loc="right")
    # The band is that of two standard errors, and the end of it lies inside the axis.
    band = shown[0].collections[0].get_paths()[0].vertices
    last = band[band[:, 0] == result.history.time[-1]][:, 1]
    value, std_error = result[result.names[0]]
    assert last.min() == pytest.approx(value - 2 * std_error) and last.max() == pytest.approx(value + 2 * std_error)
    low, high = shown[0].get_ylim()
    assert low < last.min() and last.max() < high
    figure.savefig(tmp_path / "parameters.png")
    assert (tmp_path / "parameters.png").stat().st_size > 20_000
    outputs = result.plot("outputs")
    assert "alpha [deg]" in [axes.get_ylabel() for axes in outputs.axes]
    assert len([axes for axes in result.plot(["dCm_q"]).axes]) == 1
    with pytest.raises(phugoid.PhugoidError, match="dCm_alpha"):
        result.plot("Cm_q")


def test_notebooks_show_the_status_first(flight, model, result):
    html = result._repr_html_()
    assert html.index("sound") < html.index("dCm_alpha") and html.count("<tr>") == 1 + len(result.names)
    # The pitch stiffness with the wrong sign of the elevator: refused, in red, and the numbers struck out.
    columns = flight[0].to_dict()
    columns["elevator_rad"] = -columns["elevator_rad"]
    columns["alpha_rad"] = 3 * columns["alpha_rad"]
    wrong = phugoid.estimate(phugoid.Record.from_columns(columns), model)
    assert wrong.status == "refused", wrong
    html = wrong._repr_html_()
    assert html.index("refused") < html.index(wrong.reasons[0].sentence[:10]) < html.index("dCm_alpha")
    assert "#cf222e" in html and "<s " in html and "Use neither the numbers nor their bounds" in html
    assert "2001 samples" in flight[0]._repr_html_() and ">alpha</td>" in flight[0]._repr_html_()
    assert "dCm_q" in model._repr_html_() and "needs" in model._repr_html_()
    evil = phugoid.Record.from_columns({"time_s": [0.0, 0.1], "<b>_deg": [1.0, 2.0]}, source="<script>")
    assert "<script>" not in evil._repr_html_() and "&lt;script&gt;" in evil._repr_html_()


def test_an_input_is_designed(model):
    design = phugoid.design("3-2-1-1", model=model, limits={"deflection": np.radians(2)})
    assert np.abs(design.input["elevator"]).max() <= np.radians(2) * (1 + 1e-9) and design.input.time[-1] > 15
    assert set(design.bounds) >= {"dCm_alpha", "dCm_q"} and all(bound > 0 for bound in design.bounds.values())
    assert design.to_dict()["limits"]["deflection"] == pytest.approx(np.radians(2)) and "3-2-1-1" in repr(design)
    assert "alpha" in design.flight
    assert phugoid.design("doublet").bounds == {}
    for arguments, words in [
        (dict(kind="chirp"), "doublet, 3-2-1-1, sweep, multisine"),
        (dict(kind="doublet", surfaces="flap"), "elevator, aileron and rudder"),
        (dict(kind="doublet", limits={"speed": 1.0}), "no limit on speed"),
        (dict(kind="doublet", limits={"alpha": float("nan")}), "NaN"),
        (dict(kind="doublet", limits={"alpha": -1.0}), "positive"),
        (dict(kind="doublet", duration_s=0.6), "room|long|time"),
    ]:
        with pytest.raises(phugoid.PhugoidError, match=words):
            phugoid.design(**arguments)


def test_former_spellings_work_with_a_warning(tmp_path, flight):
    path = tmp_path / "flight.csv"
    flight[0].write_csv(path)
    with pytest.warns(DeprecationWarning, match=r"phugoid\.Record\.open"):
        assert len(phugoid.read(path)) == 2001
    with pytest.warns(DeprecationWarning, match=r"phugoid\.Record\.from_columns"):
        assert phugoid.from_columns({"time_s": [0.0, 0.1], "alpha_rad": [0, 1]}).channels == ["alpha"]
    with pytest.warns(DeprecationWarning, match=r"phugoid\.Record\.from_frame"):
        assert len(phugoid.from_frame(pandas.DataFrame({"time_s": [0.0, 0.1], "alpha_rad": [0.0, 1.0]}))) == 2
    with pytest.warns(DeprecationWarning, match=r"phugoid\.Model\.open.*phugoid\.Model\.named"):
        assert phugoid.Model("f16").name == phugoid.Model.named("f16").name


def test_models_by_name_by_file_and_by_text(tmp_path):
    text = phugoid.Model.text("hfb320")
    (tmp_path / "mine.toml").write_text(text)
    names = phugoid.Model.named("hfb320").parameters
    assert phugoid.Model.open(tmp_path / "mine.toml").parameters == names == phugoid.Model.parse(text).parameters
    assert all(phugoid.Model.named(name).parameters for name in phugoid.Model.built_in())
    with pytest.raises(phugoid.PhugoidError, match="cannot read the model file"):
        phugoid.Model.open(tmp_path / "none.toml")


def test_a_parameter_has_a_value_and_a_bound(result):
    cm_alpha = result.parameter("dCm_alpha")
    assert (cm_alpha.value, cm_alpha.std_error) == result["dCm_alpha"]
    assert cm_alpha.bound == 2 * cm_alpha.std_error and cm_alpha.unit == "per rad" and cm_alpha.status == "converged"
    assert result.parameter("Cm_alpha") is None


def test_what_a_flight_holds(flight, model):
    found = phugoid.inspect(flight[0], model)
    assert found["samples"] == 2001 and found["found"]["manoeuvres"]
    assert found["support"]["model"] == "f16-model"
    assert [needs["model"] for needs in phugoid.inspect(flight[0])["models"]] == phugoid.Model.built_in()


def test_coherence_of_the_elevator(flight):
    pairs = phugoid.inspect(flight[0])["coherence"]
    pitch = next(pair for pair in pairs if (pair["input"], pair["output"]) == ("elevator", "q"))
    assert pitch["ordinary"]["peak"] > 0.95 and len(pitch["ordinary"]["values"]) == len(pitch["frequencies_hz"])


def test_bad_values_are_deleted_with_a_reason(flight, model):
    record = flight[0]
    clean = record.delete(1.0, 1.1, reason="bird strike", channels="alpha")
    assert np.isnan(clean["alpha"]).sum() == 11 and not np.isnan(record["alpha"]).any()
    assert clean.deletions == [{"from_s": 1.0, "to_s": 1.1, "reason": "bird strike", "values": {"alpha": 11}}]
    assert "bird strike" in clean.quality
    assert phugoid.estimate(clean, model).to_dict()["quality"]["deletions"][0]["reason"] == "bird strike"
    for arguments, words in [
        (dict(start=1.0, reason=" "), "say why"),
        (dict(start=99.0, reason="ice"), "runs from 0 s to 20 s"),
        (dict(start=1.0, reason="ice", channels=["alhpa"]), "did you mean 'alpha'"),
    ]:
        with pytest.raises(phugoid.PhugoidError, match=words):
            record.delete(**arguments)


def test_unknowns_of_the_sensors_are_chosen_by_name(flight):
    found = phugoid.compatibility(flight[0], unknowns=["bias_az", "scale_alpha"], hold={"bias_q": 0.0}, flat_earth=True)
    assert found.names == ["bias_az", "scale_alpha"] and found.to_dict()["held"][0]["unit"] == "rad/s"
    with pytest.raises(phugoid.PhugoidError, match="did you mean `bias_az`"):
        phugoid.compatibility(flight[0], without=["bias_za"])


def test_errors_of_the_sensors(flight):
    found = phugoid.compatibility(flight[0], groups=["delays"])
    value, std_error = found["bias_q"]
    # The simulated sensors have no bias.
    assert abs(value) < 4 * std_error
    assert "delay_alpha" in found.names and "scale_alpha" not in found.names and "bias_q" in repr(found)
    assert len(found.corrected) == len(flight[0])
    with pytest.raises(KeyError, match="bias_q"):
        found["bias_z"]
    with pytest.raises(phugoid.PhugoidError, match="air-data-scales"):
        phugoid.compatibility(flight[0], groups=["delay"])


def test_trim_and_linear_model():
    # Stevens & Lewis: a trim at 20,000 ft and 675 ft/s with the centre of gravity at 0.30 (docs/theory.md).
    trim = phugoid.trim(6096.0, 205.74, cg=0.30)
    assert trim["alpha_rad"] == pytest.approx(0.0417018499, abs=1e-9)
    linear = phugoid.linearize(6096.0, 205.74, cg=0.30)
    eigenvalues = np.linalg.eigvals(linear["longitudinal"]["A"])
    modes = linear["longitudinal"]["modes"]
    assert min(abs(eigenvalues.real - modes[0]["eigenvalue_real"])) < 1e-9


def test_aircraft_of_model_files(tmp_path):
    jet = phugoid.trim(4300.0, 104.67, aircraft="hfb320")
    # Lift and the thrust along its line, 0.0524 rad above body x, carry the weight.
    force = jet["dynamic_pressure_pa"] * 30.0968
    lift = force * (-0.318267 + 0.260317 + 5.37576 * jet["alpha_rad"])
    assert lift + jet["thrust_n"] * np.sin(jet["alpha_rad"] + 0.0524) == pytest.approx(7472 * 9.80665, rel=1e-6)
    linear = phugoid.linearize(4300.0, 104.67, aircraft="hfb320")
    assert {mode["name"] for mode in linear["longitudinal"]["modes"]} == {"short_period", "phugoid"}
    assert linear["lateral"]["modes"] == []
    assert any("half the weight" in note for note in jet["notes"]) and jet["aircraft"] == "HFB-320"
    with pytest.warns(UserWarning, match="half the weight"):
        phugoid.simulate("hfb320")
    with pytest.raises(phugoid.PhugoidError, match="no-such.toml"):
        phugoid.trim(4300.0, 104.67, aircraft=tmp_path / "no-such.toml")
    with pytest.raises(phugoid.PhugoidError, match="leave it out"):
        phugoid.trim(4300.0, 104.67, aircraft="hfb320", cg=0.2)


def test_aircraft_in_daveml(tmp_path):
    file = tmp_path / "wing.dml"
    outputs = {
        "totalCoefficientOfLift": "<apply><plus/><cn>0.3</cn><apply><times/><cn>5</cn><ci>a</ci></apply></apply>",
        "totalCoefficientOfDrag": "<cn>0.03</cn>",
        "aeroBodyMomentCoefficient_Pitch": "<apply><minus/><apply><times/><cn>-1</cn><ci>a</ci></apply><ci>e</ci></apply>",
    }
    variables = "".join(
        f'<variableDef name="{name}" varID="y{k}" units="nd"><calculation><math>{text}</math></calculation><isOutput/></variableDef>'
        for k, (name, text) in enumerate(outputs.items())
    )
    file.write_text(
        '<DAVEfunc><variableDef name="angleOfAttack" varID="a" units="rad"><isInput/></variableDef>'
        '<variableDef name="elevatorDeflection" varID="e" units="rad"><isInput/></variableDef>' + variables + "</DAVEfunc>"
    )
    with pytest.raises(phugoid.PhugoidError, match="totalMass"):
        phugoid.trim(0.0, 50.0, aircraft=file)
    basics = {"referenceWingArea": 16.0, "referenceWingSpan": 11.0, "referenceWingChord": 1.5, "totalMass": 1000.0}
    basics |= {f"bodyMomentOfInertia_{axis}": 1500.0 for axis in ("Roll", "Pitch", "Yaw")}
    trim = phugoid.trim(0.0, 50.0, aircraft=file, properties=basics)
    assert trim["elevator_rad"] == pytest.approx(-trim["alpha_rad"], abs=1e-9)
    with pytest.raises(phugoid.PhugoidError, match="leave them out"):
        phugoid.trim(0.0, 150.0, properties=basics)


def test_every_object_says_what_it_is(flight, model, result):
    assert "2001 samples" in repr(flight[0]) and "needs elevator" in repr(model)
    assert "dCm_q" in repr(result) and "no estimate yet" in repr(phugoid.Session(model))
    assert Path(phugoid.__file__).with_name("py.typed").exists()


def test_tables_without_names_or_times(tmp_path):
    (tmp_path / "bare.txt").write_text("1 0.5\n2 0.6\n3 0.7\n")
    record = phugoid.Record.open(tmp_path / "bare.txt", names=["alpha_deg", "q_deg_s"], sample_time_s=0.02)
    assert list(record.time) == [0.0, 0.02, 0.04]
    assert abs(record["alpha"][2] - np.radians(3)) < 1e-15
    (tmp_path / "clock.csv").write_text("Uhrzeit;nz\n23:59:59,5;1\n00:00:00,0;1,1\n00:00:00,5;1\n")
    record = phugoid.Record.open(tmp_path / "clock.csv")
    assert list(record.time) == [0.0, 0.5, 1.0]
    assert abs(record["az"][1] + 1.1 * 9.80665) < 1e-12


def test_a_campaign_that_was_changed_is_flown_as_it_is_now(tmp_path):
    text = 'name = "grows"\nscenarios = ["hfb320"]\nmodels = ["hfb320"]\nmethods = ["smpe"]\nseeds = 1\n'
    (tmp_path / "c.toml").write_text(text)
    fly = lambda: phugoid.campaign(tmp_path / "c.toml", tmp_path / "store")
    assert fly()["estimated"] == 1
    (tmp_path / "c.toml").write_text(text.replace("seeds = 1", "seeds = 3"))
    grown = fly()
    assert (grown["files"], grown["found"], grown["estimated"]) == (3, 1, 2)


def test_a_fleet_is_estimated_once_and_by_shards_alike(logs, tmp_path):
    done = []
    summary = phugoid.fleet(str(logs), "f16-model", tmp_path / "whole", progress=done.append)
    assert (summary["estimated"], summary["copies"], summary["refused"]) == (4, 1, 1)
    assert done[-1] == 1.0
    assert phugoid.fleet([logs], "f16-model", tmp_path / "whole")["found"] == 4
    for shard in ("2/2", "1/2"):
        phugoid.fleet(logs.glob("*"), "f16-model", tmp_path / "shards", shard=shard, workers=1)
    assert content(tmp_path / "shards") == content(tmp_path / "whole")
    told = phugoid.fleet_tell(tmp_path / "whole", html=tmp_path / "fleet.html")
    assert [airframe["name"] for airframe in told["airframes"]] == ["N17"]
    assert "flight-3.csv" in (tmp_path / "fleet.html").read_text()
    documents = phugoid.fleet_analyses(tmp_path / "whole")
    assert len(documents) == 4
    found = sorted({diagnostic["evidence"]["type"] for document in documents for diagnostic in document["diagnostics"]})
    assert found == ["AerodynamicDerivatives", "AerodynamicDerivativesMissing"]
    with pytest.raises(phugoid.PhugoidError, match="no such file"):
        phugoid.fleet("nowhere", "f16-model", tmp_path / "other")
    with pytest.raises(phugoid.PhugoidError, match='"local" or "ray"'):
        phugoid.fleet(str(logs), "f16-model", tmp_path / "other", engine="spark")


def test_ray_makes_the_store_that_this_machine_makes(logs, tmp_path):
    pytest.importorskip("ray", reason="pip install 'phugoid[fleet]'")
    phugoid.fleet(str(logs), "f16-model", tmp_path / "local")
    summary = phugoid.fleet(str(logs), "f16-model", tmp_path / "ray", engine="ray", workers=2)
    assert (summary["estimated"], summary["refused"]) == (4, 1)
    assert content(tmp_path / "ray") == content(tmp_path / "local")


def test_a_notebook_without_tqdm_gets_one_output_that_changes():
    shown = []

    class Handle:
        def update(self, content, raw):
            shown.append(content["text/plain"])

    def display(content, raw, display_id):
        shown.append(content["text/plain"])
        return Handle()

    cell = phugoid._progress._Cell("estimating", display)
    for k in range(1000):
        cell.to(k / 1000)
    cell.close()
    assert shown[0] == "estimating:   0 %" and shown[-1] == "estimating: 100 %" and len(shown) <= 21

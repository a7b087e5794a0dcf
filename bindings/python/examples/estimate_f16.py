# %% [markdown]
# # Derivatives of an F-16 from one manoeuvre
# A notebook in the percent format: Jupyter (with jupytext), VS Code and Spyder open it cell by cell; `python estimate_f16.py`
# runs it from top to bottom, as the checks of the project do.

# %%
import numpy as np

import phugoid

print(phugoid.scenarios())

# %% [markdown]
# ## A flight
# Simulated here; `phugoid.Record.open("flight.csv")` reads a recorded one, `phugoid.Record.from_frame(frame)` takes a pandas or polars frame.

# %%
flight, truth, parameters = phugoid.simulate("f16-calm", seed=7)
print(flight)
print("largest elevator:", np.degrees(np.abs(flight["elevator"]).max()), "deg")

# %% [markdown]
# ## The model
# What is known of the aircraft, and which derivatives are wanted. Start your own from `phugoid.Model.text("hfb320")`.

# %%
model = phugoid.Model.named("f16-model")
print(model)

# %% [markdown]
# ## The estimate

# %%
result = phugoid.estimate(flight, model, truth=parameters, progress=True)
print(result)
for sentence in result.verdict:
    print(sentence)

# %% [markdown]
# The histories are a record too: here the bound of one derivative at 2 s and at the end.

# %%
history = result.history
at_two_seconds = np.searchsorted(history.time, 2.0)
print("two sigma of dCm_q at 2 s:", 2 * history["dCm_q_std"][at_two_seconds], "and at the end:", 2 * history["dCm_q_std"][-1])

# %% [markdown]
# ## Sample by sample
# The code that runs on board, with the same numbers.

# %%
session = phugoid.Session(model)
samples = np.column_stack([flight[name] for name in session.channels])
for time_s, sample in zip(flight.time, samples):
    session.update(time_s, sample)
print(session)
assert np.array_equal(session.values, [result[name][0] for name in session.parameters])

# %% [markdown]
# ## Two methods on the same flights

# %%
comparison = phugoid.compare(["calm"], ["smpe", "output-error"], seeds=4, progress=True)
print(sorted(comparison))

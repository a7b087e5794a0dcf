//! The native part of the Python package `phugoid`: thin classes around the library; frames, progress bars and
//! documents are Python (`python/phugoid`).

mod aircraft;
mod design;
mod error;
mod estimation;
mod examination;
#[cfg(feature = "fleet")]
mod fleet;
mod model;
mod pickle;
mod record;
mod session;
mod studies;
mod thesis;

use pyo3::prelude::*;

#[pymodule]
fn _phugoid(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("PhugoidError", module.py().get_type::<error::PhugoidError>())?;
    module.add_class::<record::Record>()?;
    module.add_class::<model::Model>()?;
    module.add_class::<estimation::Estimation>()?;
    module.add_class::<session::Session>()?;
    module.add_class::<session::Step>()?;
    module.add_function(wrap_pyfunction!(examination::inspect, module)?)?;
    module.add_function(wrap_pyfunction!(examination::compatibility, module)?)?;
    module.add_function(wrap_pyfunction!(estimation::estimate, module)?)?;
    module.add_function(wrap_pyfunction!(design::design, module)?)?;
    module.add_function(wrap_pyfunction!(aircraft::trim, module)?)?;
    module.add_function(wrap_pyfunction!(aircraft::linearize, module)?)?;
    module.add_function(wrap_pyfunction!(studies::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(studies::compare, module)?)?;
    module.add_function(wrap_pyfunction!(studies::names, module)?)?;
    module.add_function(wrap_pyfunction!(thesis::case_toml, module)?)?;
    module.add_function(wrap_pyfunction!(thesis::cases, module)?)?;
    module.add_function(wrap_pyfunction!(thesis::reproduce, module)?)?;
    #[cfg(feature = "fleet")]
    {
        module.add_class::<fleet::CampaignTask>()?;
        module.add_class::<fleet::FleetTask>()?;
        module.add_function(wrap_pyfunction!(fleet::fleet_analyses, module)?)?;
        module.add_function(wrap_pyfunction!(fleet::fleet_files, module)?)?;
        module.add_function(wrap_pyfunction!(fleet::fleet_hash, module)?)?;
        module.add_function(wrap_pyfunction!(fleet::fleet_model, module)?)?;
        module.add_function(wrap_pyfunction!(fleet::fleet_store, module)?)?;
        module.add_function(wrap_pyfunction!(fleet::fleet_tell, module)?)?;
    }
    Ok(())
}

//! Mass, rotational inertia and the momentum of spinning rotors.

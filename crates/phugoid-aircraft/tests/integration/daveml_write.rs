//! Identified models, written and read back.

use phugoid_aircraft::daveml::{
    CheckPoint, Coefficient, Constant, Correlation, Derived, Distribution, Expression, IdentifiedModel, Input, Model,
    Term, WriteError, write,
};

fn variable(id: &str) -> Expression {
    Expression::Variable(id.to_owned())
}

fn term(id: &str, factors: &[&str], value: f64, uncertainty: f64) -> Term {
    let factors = factors.iter().map(|factor| (*factor).to_owned()).collect();
    Term { id: id.to_owned(), factors, value, standard_uncertainty: Some(uncertainty), ..Term::default() }
}

/// A pitching moment and a lift coefficient with everything that a term can have.
fn identified() -> IdentifiedModel {
    let constant = |id: &str, units: &str, value| Constant {
        id: id.to_owned(),
        units: units.to_owned(),
        value,
        ..Constant::default()
    };
    let input = |id: &str, name: &str, units: &str| Input {
        id: id.to_owned(),
        name: name.to_owned(),
        units: units.to_owned(),
        standard: true,
        ..Input::default()
    };
    let derived = |id: &str, value| Derived { id: id.to_owned(), name: String::new(), units: "nd".to_owned(), value };
    let two_v = Expression::Product(vec![Expression::Number(2.0), variable("V")]);
    IdentifiedModel {
        name: "Trainer <T-7> & \"others\"".to_owned(),
        author: "Phugoid".to_owned(),
        organisation: String::new(),
        created: "2026-07-01".to_owned(),
        description: "Holds from 40 to 60 m/s.".to_owned(),
        constants: vec![constant("cbar", "m", 1.25), constant("alpha_ref", "rad", 0.0723)],
        inputs: vec![
            input("V", "trueAirspeed", "m_s"),
            input("alpha", "angleOfAttack", "rad"),
            input("q", "bodyAngularRate_Pitch", "rad_s"),
            input("CL_base", "", "nd"),
        ],
        derived: vec![
            derived("dalpha", Expression::Difference(variable("alpha").into(), variable("alpha_ref").into())),
            derived(
                "qhat",
                Expression::Quotient(Expression::Product(vec![variable("q"), variable("cbar")]).into(), two_v.into()),
            ),
            derived(
                "stall",
                Expression::Largest(vec![
                    Expression::Number(0.0),
                    Expression::Sum(vec![Expression::Magnitude(variable("dalpha").into()), Expression::Number(-0.1)]),
                ]),
            ),
        ],
        coefficients: vec![
            Coefficient {
                id: "Cm".to_owned(),
                name: "aeroBodyMomentCoefficient_Pitch".to_owned(),
                standard: true,
                terms: vec![
                    term("Cm_0", &[], 0.0123, 0.0004),
                    term("Cm_alpha", &["dalpha"], -0.871, 0.012),
                    term("Cm_q", &["qhat"], -11.3, 0.4),
                    term("Cm_alpha2", &["dalpha", "dalpha"], 1.0 / 3.0, 0.2),
                ],
                ..Coefficient::default()
            },
            Coefficient {
                id: "CL".to_owned(),
                terms: vec![
                    Term { id: "one".to_owned(), factors: vec!["CL_base".to_owned()], value: 1.0, ..Term::default() },
                    term("CL_stall", &["stall"], -2.5e-7, 1e-9),
                ],
                ..Coefficient::default()
            },
            Coefficient { id: "CY".to_owned(), ..Coefficient::default() },
        ],
        correlations: vec![Correlation { first: "Cm_alpha".to_owned(), second: "Cm_q".to_owned(), coefficient: -0.42 }],
        check_points: [(50.0, 0.1, 0.05), (40.0, -0.3, -0.2)]
            .map(|(speed, alpha, rate)| CheckPoint {
                name: format!("at {speed} m/s"),
                inputs: [("V", speed), ("alpha", alpha), ("q", rate), ("CL_base", 0.5)]
                    .map(|(id, value)| (id.to_owned(), value))
                    .to_vec(),
            })
            .to_vec(),
    }
}

#[test]
fn what_is_written_is_read_back() {
    let written = write(&identified()).unwrap();
    let model = Model::parse(&written).unwrap_or_else(|error| panic!("{error}\n{written}"));
    let report = model.check();
    assert_eq!((report.shots_passed(), report.shots.len()), (2, 2));
    assert_eq!(report.failures().count(), 0);
    assert_eq!(model.header().name, "Trainer <T-7> & \"others\"");
    assert!(model.repaired_lines().is_empty());
    let outputs: Vec<&str> = model.outputs().map(|variable| variable.id.as_str()).collect();
    assert_eq!(outputs, ["Cm", "CL", "CY"]);
    assert_eq!(model.inputs().len(), 4);

    let mut evaluator = model.evaluator();
    for (name, value) in [("trueAirspeed", 50.0), ("angleOfAttack", 0.1), ("q", 0.05), ("CL_base", 0.5)] {
        assert!(evaluator.set(model.input_position(name).unwrap(), value));
    }
    evaluator.run();
    let (dalpha, qhat) = (0.1 - 0.0723, 0.05 * 1.25 / (2.0 * 50.0));
    let expected = 0.0123 - 0.871 * dalpha - 11.3 * qhat + dalpha * dalpha / 3.0;
    let found = evaluator.get(model.position("aeroBodyMomentCoefficient_Pitch").unwrap());
    assert!((found - expected).abs() < 1e-15, "{found}, {expected}");
    assert_eq!(evaluator.get(model.position("CL").unwrap()), 0.5);
    assert_eq!(evaluator.get(model.position("CY").unwrap()), 0.0);

    let cm_q = model.variable("Cm_q").unwrap();
    assert_eq!(cm_q.initial, Some(-11.3));
    let doubt = cm_q.uncertainty.clone().unwrap();
    assert_eq!(doubt.standard_deviation(-11.3), Some(0.4));
    let Distribution::Normal { correlations, .. } = doubt.distribution else { panic!() };
    assert_eq!(correlations, [("Cm_alpha".to_owned(), -0.42)]);
    assert_eq!(model.variable("Cm_alpha2").unwrap().initial, Some(1.0 / 3.0));
    assert!(model.variable("one").unwrap().uncertainty.is_none());
}

#[test]
fn what_cannot_be_written_is_said() {
    let with = |change: &dyn Fn(&mut IdentifiedModel)| {
        let mut model = identified();
        change(&mut model);
        write(&model).unwrap_err()
    };
    assert!(matches!(with(&|m| m.constants[0].id = "c bar".to_owned()), WriteError::Identifier(_)));
    assert!(matches!(with(&|m| m.constants[0].id = "V".to_owned()), WriteError::Repeated(_)));
    assert!(matches!(with(&|m| m.inputs[0].name = "angleOfAttack".to_owned()), WriteError::Repeated(_)));
    assert!(matches!(with(&|m| m.constants[0].value = f64::NAN), WriteError::Number { .. }));
    let negative = Some(-1.0);
    assert!(matches!(with(&|m| m.coefficients[0].terms[0].standard_uncertainty = negative), WriteError::Number { .. }));
    assert!(matches!(with(&|m| m.correlations[0].second = "one".to_owned()), WriteError::Correlation(_)));
    assert!(matches!(with(&|m| m.correlations[0].coefficient = 1.1), WriteError::Number { .. }));
    assert!(matches!(with(&|m| drop(m.check_points[0].inputs.pop())), WriteError::CheckPoint { .. }));
    assert!(matches!(with(&|m| m.check_points[0].inputs[0].1 = 0.0), WriteError::Number { .. }));
    assert!(matches!(
        with(&|m| m.coefficients[0].terms[0].factors.push("nowhere".to_owned())),
        WriteError::Contradiction(_)
    ));
    let mut deep = variable("alpha");
    for _ in 0..100 {
        deep = Expression::Magnitude(deep.into());
    }
    assert!(matches!(with(&|m| m.derived[0].value = deep.clone()), WriteError::Deep(_)));
}

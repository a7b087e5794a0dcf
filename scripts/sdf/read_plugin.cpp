// Reads the parameters of gz-sim's AdvancedLiftDrag from an SDF file with libsdformat, as a simulator does, and prints a line for each:
// "name value". Ends with 1 where libsdformat finds an error, with 2 where a parameter is not there or no number.
#include <iostream>
#include <string>

#include <ignition/math/Vector3.hh>
#include <sdf/sdf.hh>

static int failures = 0;

// A number of an element, as the plugin gets it; what is not there would silently be a default in the simulator.
static void number(const sdf::ElementPtr &element, const std::string &name, const std::string &prefix = "") {
  if (!element->HasElement(name)) {
    std::cerr << prefix << name << " is not there\n";
    failures++;
    return;
  }
  // Text first: a value that is no number would be read as zero.
  const std::string text = element->GetElement(name)->Get<std::string>();
  try {
    std::size_t used = 0;
    const double value = std::stod(text, &used);
    if (used != text.size() || value != element->Get<double>(name)) throw std::invalid_argument(text);
    std::cout << prefix << name << ' ' << text << '\n';
  } catch (const std::exception &) {
    std::cerr << prefix << name << " is '" << text << "', no number\n";
    failures++;
  }
}

int main(int argc, char **argv) {
  if (argc != 2) {
    std::cerr << "usage: read_plugin FILE.sdf\n";
    return 2;
  }
  sdf::Root root;
  for (const auto &error : root.Load(argv[1])) {
    std::cerr << error << '\n';
    failures++;
  }
  if (failures > 0) return 1;
  const sdf::Model *model = root.Model();
  if (model == nullptr || !model->Element()->HasElement("plugin")) {
    std::cerr << "no model with a plugin\n";
    return 1;
  }
  const sdf::ElementPtr plugin = model->Element()->GetElement("plugin");
  std::cout << "filename " << plugin->Get<std::string>("filename") << "\nname " << plugin->Get<std::string>("name") << '\n';
  for (const char *name : {"CL0", "CD0", "Cem0", "CLa", "CYa", "Cella", "Cema", "Cena", "CLb", "CYb", "Cellb", "Cemb", "Cenb",
                           "alpha_stall", "Cema_stall", "CDp", "CYp", "CLp", "Cellp", "Cemp", "Cenp", "CDq", "CYq", "CLq",
                           "Cellq", "Cemq", "Cenq", "CDr", "CYr", "CLr", "Cellr", "Cemr", "Cenr", "num_ctrl_surfaces", "AR",
                           "mac", "eff", "air_density", "area"})
    number(plugin, name);
  for (const char *name : {"cp", "forward", "upward"}) {
    if (!plugin->Get<ignition::math::Vector3d>(name, ignition::math::Vector3d(7, 7, 7)).second) {
      std::cerr << name << " is no vector\n";
      failures++;
    }
  }
  int surfaces = 0;
  for (auto surface = plugin->FindElement("control_surface"); surface; surface = surface->GetNextElement("control_surface")) {
    const std::string prefix = surface->Get<std::string>("name") + ".";
    for (const char *name : {"direction", "CD_ctrl", "CY_ctrl", "CL_ctrl", "Cell_ctrl", "Cem_ctrl", "Cen_ctrl"})
      number(surface, name, prefix);
    surfaces++;
  }
  if (surfaces != plugin->Get<int>("num_ctrl_surfaces")) {
    std::cerr << "num_ctrl_surfaces is not the number of control surfaces\n";
    failures++;
  }
  return failures > 0 ? 2 : 0;
}

// What cameras can see in a scene, by its labels.
#pragma once

#include <string>
#include <vector>

namespace rigwire::sim {

class Scene;

/// Labels of everything in the scene, and of what lies on its terrains; sorted, each once.
[[nodiscard]] std::vector<std::string> visible_labels(const Scene& scene);

}  // namespace rigwire::sim

#pragma once
// Collision queries of the command line: the ground that they are asked of, and tables of questions.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "scene_run.h"

#include "tafoni/field/compiled.h"
#include "tafoni/query/collider.h"
#include "tafoni/query/walks.h"

namespace tafoni::cli {

/// What collides: the surface of a scene's mesh, made where it is asked for, or a mesh file.
struct CollisionGround {
  std::unique_ptr<query::Collider> collider;
  Vec3d origin;                               ///< world position of local zero
  std::optional<field::CompiledField> field;  ///< of a scene
};
CollisionGround ground_of_scene(const scene::BuiltScene& scene);
CollisionGround ground_of_mesh(const std::string& path);

/// Answers as columns; what there is no answer to stays empty (null in JSON).
struct AnswerTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::optional<double>>> rows;

  std::string text(bool json) const;
};

/// A kind of question: an option of `query` that takes a table.
struct Question {
  std::string flag, doc;
  std::vector<std::string_view> columns;  ///< of the table it takes
  std::vector<std::string> answers;       ///< columns that come after those
  /// Positions are local in the question and in the answer, each three columns that begin with an x.
  std::vector<std::optional<double>> (*ask)(const query::Collider&, const std::vector<double>&) = nullptr;
  std::size_t answer_point = 0;  ///< column among the answers where a position begins; 0: none
};
const std::vector<Question>& all_questions();

/// Questions as they were written, and where; `name` and `lines` are for messages.
struct QuestionTable {
  std::string name;
  std::vector<std::vector<double>> rows;
  std::vector<std::uint32_t> lines;
};
/// Throws Error{input} "NAME:LINE: …" for a row that cannot be asked.
AnswerTable answer(const Question& question, const CollisionGround& ground, const QuestionTable& asked,
                   Progress& progress);

/// Walks and tells of it; the table has a row a route. Throws Error{invalid} once told where a route was not
/// completed or the walker was in the rock by more than a tenth of a millimetre.
AnswerTable walk(const CollisionGround& ground, const query::WalkSettings& settings, Console& console);
void check_walks(const AnswerTable& walks);

}  // namespace tafoni::cli

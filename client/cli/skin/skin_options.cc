#include "client/cli/skin/skin_options.h"

#include "client/cli/command.h"

namespace gelenk::cli {
namespace {

CLI::App* AddStep(CLI::App& skin, const std::string& name,
                  const std::string& description, SkinOptions* options) {
  CLI::App* step = skin.add_subcommand(name, description);
  SkinSourceOptions* source = &options->source;
  step->add_option("SKIN", source->path,
                   "arm, leg, humanoid, cylinder, a .glb, .gltf, .obj or .json "
                   "file, or skins/NAME on a server")
      ->required()
      ->option_text("");
  step->add_option("--skeleton", source->skeleton_path,
                   "The skeleton of an .obj or .json file")
      ->option_text("FILE");
  step->add_option("--vertices", source->vertex_count,
                   "About so many, of a bundled shape; default 10000")
      ->option_text("N");
  step->add_option("--unit", source->unit_m,
                   "Metres per unit of a .glb, .gltf or .obj file; default 1")
      ->check(Positive())
      ->option_text("M");
  step->add_option("--skin", source->skin, "Of a glTF file: its skin")
      ->option_text("NAME");
  step->add_option("--mesh", source->mesh,
                   "Of a glTF file: the one mesh to take; default: all")
      ->option_text("NAME");
  AddChoice<SkinMethod>(*step, "--method", &source->method,
                        {{"layered", SkinMethod::kLayered},
                         {"linear", SkinMethod::kLinear},
                         {"dual", SkinMethod::kDualQuaternion}},
                        "Volumes, or the weights of a glTF file; default "
                        "layered");
  step->add_option("--assignments", options->assignments_path,
                   "What was decided by hand; rebind writes it")
      ->option_text("FILE.json");
  return step;
}

void AddRebindOptions(CLI::App& rebind, SkinOptions* options) {
  AddSelectorOptions(rebind, &options->selector);
  rebind
      .add_option("--link", options->link_id,
                  "The joint whose link they go to; without it earlier "
                  "decisions are taken back")
      ->option_text("JOINT");
  AddChoice<v1::AssignmentScope>(rebind, "--scope", &options->scope,
                                 {{"chain", v1::ASSIGNMENT_SCOPE_CHAIN},
                                  {"link", v1::ASSIGNMENT_SCOPE_LINK}},
                                 "To the link's chain, or to the very link; "
                                 "default chain");
  rebind.add_flag("--dry-run", options->dry_run, "Only say what would be");
  CLI::Option* undo = rebind.add_flag(
      "--undo", options->undo, "Go back to the revision before; of skins/NAME");
  for (CLI::Option* other : rebind.get_options()) {
    if (other != undo && !other->get_positional() &&
        other != rebind.get_help_ptr()) {
      undo->excludes(other);
    }
  }
  for (CLI::App* group : rebind.get_subcommands({})) group->excludes(undo);
}

void AddDeformOptions(CLI::App& deform, SkinOptions* options) {
  AddPoseOptions(deform, &options->poses);
  AddChoice<v1::VertexEncoding>(
      deform, "--encoding", &options->encoding,
      {{"float32", v1::VERTEX_ENCODING_FLOAT32},
       {"quantized", v1::VERTEX_ENCODING_QUANTIZED_16_OCT_8},
       {"delta", v1::VERTEX_ENCODING_DELTA},
       {"planes", v1::VERTEX_ENCODING_CONTROL_PLANES}},
      "How vertices travel; default quantized");
  deform
      .add_option("--picture", options->picture_path,
                  "Draw up to eight of the frames")
      ->check(EndsWith({".svg"}))
      ->option_text("FILE.svg");
  deform
      .add_option("--out", options->out_path,
                  "Write the vertices of the last frame")
      ->check(EndsWith({".obj"}))
      ->option_text("FILE.obj");
}

void AddDemoOptions(CLI::App& demo, SkinDemoOptions* options) {
  demo.add_option("--picture", options->picture_path, "Draw it")
      ->check(EndsWith({".svg"}))
      ->option_text("FILE.svg");
  demo.add_option("--out", options->glb_path, "As an animated glTF file")
      ->check(EndsWith({".glb"}))
      ->option_text("FILE.glb");
  demo.add_option("--vertices", options->vertex_count,
                  "About so many; default 3000")
      ->option_text("N");
}

}  // namespace

void AddSkinSteps(CLI::App& skin, SkinOptions* options) {
  skin.require_subcommand(1);
  options->bind =
      AddStep(skin, "bind", "Which link each vertex follows", options);
  options->report =
      AddStep(skin, "report", "The same, with the vertices that are not clear",
              options);
  for (CLI::App* step : {options->bind, options->report}) {
    AddFormatOption(*step, &options->format);
  }
  options->bind
      ->add_option("--keep", options->keep_id,
                   "Leave it on the server as skins/ID")
      ->option_text("ID");
  options->rebind = AddStep(
      skin, "rebind", "Decide by hand which link vertices follow", options);
  AddRebindOptions(*options->rebind, options);
  options->deform = AddStep(skin, "deform", "Vertices at poses", options);
  AddDeformOptions(*options->deform, options);
  options->do_export = AddStep(
      skin, "export", "As a plain glTF skin: bones and weights", options);
  AddPoseOptions(*options->do_export, &options->poses);
  options->do_export->add_option("--out", options->out_path, "A .glb file")
      ->required()
      ->check(EndsWith({".glb"}))
      ->option_text("FILE.glb");
  options->list = skin.add_subcommand("list", "The skins on a server");
  AddFormatOption(*options->list, &options->format);
  options->remove =
      skin.add_subcommand("delete", "Deletes a skin with all its revisions");
  options->remove
      ->add_option("SKIN", options->source.path, "skins/NAME on a server")
      ->required()
      ->option_text("");
  options->demo = skin.add_subcommand(
      "demo",
      "An arm bends from 0 to 150 degrees, with its biceps and without");
  AddDemoOptions(*options->demo, &options->demonstration);
  skin.footer(
      "Examples:\n"
      "  gelenk skin bind humanoid\n"
      "  gelenk skin bind body.obj --skeleton walk.bvh\n"
      "  gelenk skin rebind humanoid --sphere 0.3,1,0,0.1 --link chest "
      "--dry-run\n"
      "  gelenk skin deform body.obj --skeleton walk.bvh --bvh walk.bvh "
      "--picture walk.svg\n"
      "  gelenk skin export arm --out arm.glb\n"
      "  gelenk skin demo --picture arm.svg --out arm.glb");
}

}  // namespace gelenk::cli

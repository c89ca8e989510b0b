// gelenk sessions: what lives on a server.
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/cli/command.h"
#include "client/cli/service.h"
#include "client/cli/session_text.h"

namespace gelenk::cli {
namespace {

constexpr char kCollection[] = "sessions/";
constexpr int kPageSize = 1000;

// What stands behind "sessions/", which may be left out.
std::string IdOf(const std::string& name) {
  return std::string(absl::StripPrefix(name, kCollection));
}

absl::StatusOr<std::vector<v1::Session>> ListAll(
    client::Connection& connection) {
  std::vector<v1::Session> sessions;
  v1::ListSessionsRequest request;
  request.set_page_size(kPageSize);
  do {
    const absl::StatusOr<v1::ListSessionsResponse> page =
        connection.Call(&v1::SessionService::Stub::ListSessions, request);
    if (!page.ok()) return page.status();
    sessions.insert(sessions.end(), page->sessions().begin(),
                    page->sessions().end());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return sessions;
}

absl::Status PrintAll(client::Connection& connection, Format format,
                      std::string* output) {
  const auto sessions = ListAll(connection);
  if (!sessions.ok()) return sessions.status();
  *output += format == Format::kJson ? JsonText(SessionListJson(*sessions))
                                     : SessionListText(*sessions);
  return absl::OkStatus();
}

absl::Status PrintOne(client::Connection& connection, const std::string& name,
                      Format format, std::string* output) {
  client::CallOptions options;
  options.affinity_key = IdOf(name);
  v1::GetSessionRequest request;
  request.set_name(absl::StrCat(kCollection, IdOf(name)));
  const absl::StatusOr<v1::Session> session =
      connection.Call(&v1::SessionService::Stub::GetSession, request, options);
  if (!session.ok()) return session.status();
  *output += format == Format::kJson ? JsonText(SessionJson(*session))
                                     : SessionText(*session);
  return absl::OkStatus();
}

absl::Status DeleteOne(client::Connection& connection,
                       const std::string& name) {
  client::CallOptions options;
  options.affinity_key = IdOf(name);
  v1::DeleteSessionRequest request;
  request.set_name(absl::StrCat(kCollection, IdOf(name)));
  return connection
      .Call(&v1::SessionService::Stub::DeleteSession, request, options)
      .status();
}

struct SessionsOptions {
  Format format = Format::kTable;
  std::string get_name;
  std::string delete_name;
};

absl::Status RunSessions(const SessionsOptions& options,
                         const GlobalOptions& globals, std::string* output) {
  const auto service = Service::Open(globals.server);
  if (!service.ok()) return service.status();
  client::Connection& connection = *(*service)->connection();
  if (!options.delete_name.empty()) {
    return DeleteOne(connection, options.delete_name);
  }
  if (!options.get_name.empty()) {
    return PrintOne(connection, options.get_name, options.format, output);
  }
  return PrintAll(connection, options.format, output);
}

}  // namespace

Command AddSessionsCommand(CLI::App& app) {
  auto options = std::make_shared<SessionsOptions>();
  CLI::App* sessions = app.add_subcommand(
      "sessions", "List, show or delete the sessions of a running service");
  // A service of the command's own would have none.
  sessions->needs(app.get_option("--server"));
  sessions->require_subcommand(0, 1);
  AddFormatOption(*sessions, &options->format);
  sessions->add_subcommand("list", "List them all (default)")->fallthrough();
  CLI::App* get = sessions->add_subcommand("get", "Show one")->fallthrough();
  get->add_option("NAME", options->get_name, "Its id, or sessions/ID")
      ->required()
      ->option_text("");
  CLI::App* remove =
      sessions->add_subcommand("delete", "End one")->fallthrough();
  remove->add_option("NAME", options->delete_name, "Its id, or sessions/ID")
      ->required()
      ->option_text("");
  sessions->footer(
      "Examples:\n"
      "  gelenk --server localhost:50051 sessions\n"
      "  gelenk --server localhost:50051 sessions get dancer --format json\n"
      "  gelenk --server localhost:50051 sessions delete dancer");
  return {sessions,
          [options](const GlobalOptions& globals, std::string* output) {
            return RunSessions(*options, globals, output);
          }};
}

}  // namespace gelenk::cli

# The environment server as one static program: no shell, no package, not root. It asks for an access token:
#   docker build -t gym-babble-server .
#   docker run -p 8000:8000 -e GYM_BABBLE_TOKEN gym-babble-server
FROM rust:1.95-alpine AS build
WORKDIR /source
COPY . .
# The C library is in the program: this target links it statically.
RUN CARGO_PROFILE_RELEASE_STRIP=true cargo build --release --locked -p babble_server

FROM scratch
COPY --from=build /source/target/release/gym-babble-server /gym-babble-server
COPY LICENSE-APACHE LICENSE-MIT /
USER 65532:65532
EXPOSE 8000
HEALTHCHECK --interval=30s --timeout=5s --start-period=5s \
    CMD ["/gym-babble-server", "--host", "0.0.0.0", "--port", "8000", "health"]
ENTRYPOINT ["/gym-babble-server", "--host", "0.0.0.0", "--port", "8000"]
